"""Single mutations of the code, and the tests that must fail under each (docs/decisions/0014-mutations.md).

    python benchmarks/mutations.py [--only loads/contact.py]

Each entry of mutations.toml names a file under src/faying, a text that stands in it once, another text in its place,
and tests. src is copied to a temporary folder, where one mutation after another is made and taken back; the checkout
stays as it is. All named tests have to pass without any mutation. A mutation that they pass lives: `lives` of its entry
says why no test has to fail. Exit code 1 where one without that reason lives. Four minutes of one core.
"""

import argparse
import os
import re
import shutil
import subprocess
import sys
import tempfile
import tomllib
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).parents[1]
FAILED = re.compile(r"^(?:FAILED|ERROR) (.+?)(?: - .*)?$", re.MULTILINE)


@dataclass(frozen=True, kw_only=True)
class Mutation:
    """One change of one line: file under src/faying, text, text in its place, tests, and why it may live."""

    file: str
    old: str
    new: str
    tests: tuple[str, ...]
    lives: str = ""

    def made(self, text: str) -> str:
        """The text of the file with the change. Raises ValueError where what is to change is not there once."""
        if text.count(self.old) != 1 or self.old == self.new:
            raise ValueError(f"{self.file}: {self.old!r} stands in it {text.count(self.old)} times; it has to be once")
        return text.replace(self.old, self.new)


def failed(source: Path, tests: Sequence[str]) -> str:
    """The first of some tests that fails with a copy of src, "" where all pass. Raises RuntimeError where none runs."""
    command = [sys.executable, "-m", "pytest", "-x", "-q", "-rfE", "-p", "no:cacheprovider", *tests]
    given = os.environ | {"PYTHONPATH": str(source), "OMP_NUM_THREADS": "1"}
    run = subprocess.run(command, cwd=ROOT, env=given, capture_output=True, text=True)
    found = FAILED.search(run.stdout)
    if run.returncode > 1 or (run.returncode and found is None):  # as a text that is no Python
        raise RuntimeError(run.stdout + run.stderr)
    return found[1] if run.returncode and found is not None else ""


def main() -> int:
    """Print what became of each mutation; 1 where one lives that should not."""
    ask = argparse.ArgumentParser()
    ask.add_argument("--only", default="", help="mutations of files whose name has this in it")
    given = ask.parse_args()
    entries = tomllib.loads(Path(__file__).with_suffix(".toml").read_text(encoding="utf-8"))["mutation"]
    every = [Mutation(**entry | {"tests": tuple(entry["tests"])}) for entry in entries if given.only in entry["file"]]
    faults = 0
    with tempfile.TemporaryDirectory() as folder:
        source = Path(folder) / "src"
        shutil.copytree(ROOT / "src", source, ignore=shutil.ignore_patterns("__pycache__"))
        files = [source / "faying" / one.file for one in every]
        texts = [file.read_text(encoding="utf-8") for file in files]
        changed = [one.made(text) for one, text in zip(every, texts, strict=True)]
        fault = failed(source, sorted({test for one in every for test in one.tests}))
        if fault:
            print(f"without any mutation {fault} fails")
            return 1
        for one, file, text, made in zip(every, files, texts, changed, strict=True):
            file.write_text(made, encoding="utf-8")
            by = failed(source, one.tests)
            file.write_text(text, encoding="utf-8")
            faults += not by and not one.lives
            print(f"{'killed' if by else 'LIVES':7s}{one.file:29s}{one.new[:48]:50s}{by or one.lives}", flush=True)
    print(f"{len(every)} mutations, {faults} of them live and should not")
    return int(faults > 0)


if __name__ == "__main__":
    sys.exit(main())
