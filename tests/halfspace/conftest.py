import pytest

from tests.helpers.self_affine import self_affine


@pytest.fixture(scope="session")
def rough():
    """Self-affine heights by side and seed."""
    return lambda n, seed=0, **changes: self_affine(n, seed, **changes)
