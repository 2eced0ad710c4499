"""What `faying check` says of fourteen assemblies beside what `faying run` needs and finds.

    python benchmarks/assemblies.py [--names t_slots cover ...] [--steps FOLDER] [--as-proposed] [--keep FOLDER]

Each assembly goes from its STEP file by `faying new --yes` to its study, with elements as coarse as the tests have them
and the law of JK on flat faces; --as-proposed leaves the study as `new` writes it. Two further ones are read from
--steps. CPU seconds of the whole command on one thread, its greatest resident memory, the mean pressure of each joint:
said by `check`, of the run, and their ratio. --keep stores the numbers of each run and takes those that are there.
"""

import argparse
import json
import os
import re
import statistics
import subprocess
import sys
import tempfile
from pathlib import Path

for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ[name] = "1"
ROOT = Path(__file__).parent.parent
sys.path[:0] = [str(ROOT)]


def used(command):
    """What a command printed, its CPU seconds and its greatest resident memory [B]."""
    with tempfile.TemporaryFile("w+") as out, tempfile.TemporaryFile("w+") as faults:
        process = subprocess.Popen(command, stdout=out, stderr=faults, text=True)
        _, status, usage = os.wait4(process.pid, 0)
        if status:
            faults.seek(0)
            raise RuntimeError(f"{' '.join(command)}\n{faults.read()}")
        out.seek(0)
        return out.read(), usage.ru_utime + usage.ru_stime, 1024 * usage.ru_maxrss


def study_of(name, steps, folder, as_proposed):
    """The study of an assembly, written by `faying new`."""
    from tests.helpers import assemblies
    from tests.helpers.proposed import proposed

    step = folder / f"{name}.step"
    if name in assemblies.MADE:
        assemblies.made(name, step)
    else:
        step.write_bytes((steps / f"{name}.step").read_bytes())
    if as_proposed:
        toml = step.with_suffix(".toml")
        subprocess.run([sys.executable, "-m", "faying", "new", step, "--yes", "--out", toml], check=True)
        return toml
    return proposed(step, assemblies.SIZES[name])


def measured(toml):
    """Numbers that are said of a study and found by its run."""
    from faying.units import parse

    text, check_seconds, _ = used([sys.executable, "-m", "faying", "check", str(toml), "--json"])
    said = json.loads(text)
    out = toml.parent / f"results-{toml.stem}"
    _, seconds, memory = used([sys.executable, "-m", "faying", "run", str(toml), "--quiet", "--out", str(out)])
    import faying

    found = faying.load(out / "result.nc")
    pressures = {}
    for number, joint in enumerate(found.joints):
        here = found.joint_of_point == number
        mean = found.pressure[0][here] @ found.weights[here] / found.weights[here].sum()
        line = next(
            one["text"]
            for one in said["findings"]
            if one["text"].startswith(f"joint '{joint}'") and " press " in one["text"]
        )
        pressures[joint] = parse(re.search(r" press ([\d.]+ \w+) on it", line)[1], "Pa"), mean
    expected = said["expected"]
    return {
        "check": check_seconds,
        "unknowns": (expected["unknowns"], found.unknowns),
        "seconds": (expected["time"]["values"], seconds),
        "memory": (expected["memory"]["values"], memory),
        "pressures": pressures,
        "mesh error": [float(x) for x in found.mesh_error[-1]],
        "frequencies": [float(x) for x in found.frequencies[-1]],
    }


def main():
    from tests.helpers import assemblies

    ask = argparse.ArgumentParser()
    ask.add_argument("--names", nargs="+", default=list(assemblies.SIZES))
    ask.add_argument("--steps", type=Path, help="folder of further STEP files")
    ask.add_argument("--as-proposed", action="store_true", help="the study as `new` writes it, size and law included")
    ask.add_argument("--keep", type=Path, help="folder for the numbers of each run")
    given = ask.parse_args()
    with tempfile.TemporaryDirectory() as name:
        folder = given.keep or Path(name)
        folder.mkdir(exist_ok=True)
        heads = "".join(f"  {what:>13}   ratio" for what in ("unknowns", "GB", "CPU s", "MPa, worst"))
        print(f"{'assembly':<20}{heads}", flush=True)
        ratios = []
        for assembly in given.names:
            if assembly not in assemblies.MADE and given.steps is None:
                continue
            kept = folder / f"{assembly}{'-proposed' * given.as_proposed}.json"
            if not kept.exists():
                try:
                    toml = study_of(assembly, given.steps, folder, given.as_proposed)
                    kept.write_text(json.dumps(measured(toml)))
                except RuntimeError as fault:
                    print(f"{assembly:<20} {fault}", flush=True)
                    continue
            one = json.loads(kept.read_text())
            (n, m), (b, c), (s, t) = one["unknowns"], one["memory"], one["seconds"]
            p, q = max(one["pressures"].values(), key=lambda pair: abs(pair[0] / pair[1] - 1))
            ratios.append((n / m, b / c, s / t, p / q))
            cells = f"{n:>7,}{m:>8,}{n / m:>8.2f}{b / 1e9:>10.2f}{c / 1e9:>7.2f}{b / c:>8.2f}"
            cells += f"{s:>10.0f}{t:>7.0f}{s / t:>8.2f}"
            print(f"{assembly:<20}{cells}{p / 1e6:>10.1f}{q / 1e6:>7.1f}{p / q:>8.2f}", flush=True)
        for what, some in zip(
            ("unknowns", "memory", "CPU seconds", "mean pressure"), zip(*ratios, strict=True), strict=True
        ):
            print(f"{what}: {min(some):.2f} to {max(some):.2f}, median {statistics.median(some):.2f}")


if __name__ == "__main__":
    main()
