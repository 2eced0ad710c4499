import sys
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).parents[3] / "benchmarks"))

from self_affine import self_affine


@pytest.fixture(scope="session")
def rough():
    """Self-affine heights by side and seed."""
    return lambda n, seed=0, **changes: self_affine(n, seed, **changes)
