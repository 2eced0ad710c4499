"""The examples, each in a folder of its own with the data that it is made of."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
MEASURED = Path(os.environ.get("FAYING_DATA", ROOT.parent / "shared" / "data")) / "brake-reuss-beam"
MEASURED = MEASURED / "brb_surface_data.mat"


def copied(study, target):
    """The path of the study of an example in a copy of all examples; skips where its data cannot be made."""
    shutil.copytree(ROOT / "examples", target, ignore=shutil.ignore_patterns("results", "data"))
    path = target / study.relative_to(ROOT / "examples")
    if (path.parent / "make_data.py").is_file():
        if not MEASURED.is_file():
            pytest.skip(f"the measured interface is absent: {MEASURED}; set FAYING_DATA")
        subprocess.run([sys.executable, str(path.parent / "make_data.py"), str(MEASURED)], check=True)
    return path
