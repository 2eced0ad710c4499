"""One thread for every library, the same examples in every run of CI, and each contact solved once in a run."""

import atexit
import os
import shutil
import sys
import tempfile

import pytest
from hypothesis import settings

from tests.helpers.browser import browser as browser
from tests.helpers.published import Published

for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ.setdefault(name, "1")

# workers and commands that tests start then compile each module once, not at every start
os.environ.pop("PYTHONDONTWRITEBYTECODE", None)
sys.dont_write_bytecode = False

# the workers of a run inherit the folder from the process that starts them
if "FAYING_CACHE" not in os.environ:
    os.environ["FAYING_CACHE"] = tempfile.mkdtemp(prefix="faying-tests-")
    atexit.register(shutil.rmtree, os.environ["FAYING_CACHE"], ignore_errors=True)


def pytest_addoption(parser):
    parser.addoption("--half", choices=("0", "1"), help="every other test, from the first or second")


def pytest_collection_modifyitems(config, items):
    half = config.getoption("half")
    if half is not None:
        config.hook.pytest_deselected(items=items[1 - int(half) :: 2])
        items[:] = items[int(half) :: 2]


@pytest.fixture
def published(request):
    """Compare with a published number, and put it into the site's table where that is asked for."""
    return Published(request.node.nodeid)


# no deadlines: the first example of a test imports, and machines differ
settings.register_profile("plain", deadline=None)
settings.register_profile("ci", deadline=None, derandomize=True, print_blob=True)
settings.load_profile("ci" if os.environ.get("CI") else "plain")
