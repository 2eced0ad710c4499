"""`faying run` of the T-specimen from the command line: three preloads and twelve, start-up, files and figures too.

    python benchmarks/run.py [--repeats 3]

Its own law and JK, each alone: with [[alternative]] the two share the mesh. The scan's contact is
solved before and its STEP file meshed, as in any run but the first (`faying run` keeps both); Python has compiled its
modules; on one thread. Medians of CPU seconds. With --fresh also those with the mesh made anew, and those of first
runs, which solve the contact of the scan, too."""

import argparse
import os
import re
import resource
import shutil
import statistics
import subprocess
import sys
import tempfile
from pathlib import Path

for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ[name] = "1"
os.environ.pop("PYTHONDONTWRITEBYTECODE", None)  # or every run would compile all modules anew
EXAMPLE = Path(__file__).parent.parent / "examples" / "t-specimen"
LOADS = {
    "4, 8, 12 kN": (4, 8, 12),
    "twelve, 4 to 12 kN": [4 + 8 * k / 11 for k in range(12)],
    "twelve, 1 to 12 kN": range(1, 13),
}


def study(law, loads):
    """The example's study under one law and at some loads, without its test, which is one at three loads."""
    text = (EXAMPLE / "study.toml").read_text(encoding="utf-8")
    text = re.sub(r"# The law of the scan.*?(?=\[\[bolt\]\])", "", text, flags=re.DOTALL)
    text = re.sub(r"\[test\].*", "", text, flags=re.DOTALL)
    wanted = ", ".join(f'"{load:.6g} kN"' for load in loads)
    return re.sub(r"preload = \[.*\]", f"preload = [{wanted}]", text) + (f'\n[law]\nmodel = "{law}"\n' if law else "")


def seconds(folder, anew=""):
    """CPU seconds of one run, children included; anew: pattern of what is not kept from runs before."""
    for kept in (folder / ".faying").glob(anew) if anew else ():
        kept.unlink()
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    command = [sys.executable, "-m", "faying", "run", str(folder / "study.toml"), "--quiet"]
    subprocess.run(command, check=True, capture_output=True)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def main():
    ask = argparse.ArgumentParser()
    ask.add_argument("--repeats", type=int, default=3)
    ask.add_argument("--laws", nargs="+", choices=("default", "jk"), default=["default", "jk"])
    ask.add_argument("--fresh", action="store_true", help="print the seconds with less kept, too")
    given = ask.parse_args()
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        for file in ("t-specimen.step", "milled.x3p"):
            shutil.copy(EXAMPLE / file, folder)
        for law in given.laws:
            bases: dict[str, float] = {}
            for label, loads in LOADS.items():
                (folder / "study.toml").write_text(study("" if law == "default" else law, loads), encoding="utf-8")
                if label == next(iter(LOADS)):
                    seconds(folder)
                kinds = {"": ""} | ({", mesh anew": "mesh-*", ", first run": "*"} if given.fresh else {})
                for kind, anew in kinds.items():
                    found = statistics.median(seconds(folder, anew) for _ in range(given.repeats))
                    ratio = found / bases.setdefault(kind, found)
                    print(f"{law:12s} {label + kind:32s} {found:6.1f} CPU s, {ratio:.2f} of three", flush=True)


if __name__ == "__main__":
    main()
