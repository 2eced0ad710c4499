"""CPU seconds of random vibration and of a sweep over those of the run without them, ten modes.

    python benchmarks/vibration.py [STUDY]

The bracket of the examples, or another study with [[vibration]]. One thread; the mesh and the law are made before.
"""

import argparse
import os
import time
from dataclasses import replace
from pathlib import Path
from typing import Any

for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ[name] = "1"

BRACKET = Path(__file__).parent.parent / "examples" / "bracket" / "shaker.toml"


def seconds(study: Any) -> float:
    """CPU seconds of the run of a study."""
    import faying

    before = time.process_time()
    faying.run(study)
    return time.process_time() - before


def main() -> None:
    """Print the shares."""
    from faying.study import Study

    ask = argparse.ArgumentParser()
    ask.add_argument("study", nargs="?", type=Path, default=BRACKET)
    study = Study.read(ask.parse_args().study)
    study = replace(study, modes=replace(study.modes, count=10))
    alone = replace(study, vibrations=())
    seconds(alone)
    base = seconds(alone)
    print(f"{len(study.preloads)} preloads, without vibration: {base:.1f} CPU s")
    for one in study.vibrations:
        more = seconds(replace(study, vibrations=(one,))) - base
        print(f"{one.name}, {one.kind}: {more:.1f} CPU s more, {more / base:.2f} of the run")


if __name__ == "__main__":
    main()
