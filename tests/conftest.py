"""One thread for every library, the same examples in every run of CI, and each contact solved once in a run."""

import atexit
import os
import shutil
import sys
import tempfile
import time

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
    parser.addoption(
        "--begin", type=int, default=0, help="begin after this share of the tests [%%]; the first are last"
    )
    parser.addoption("--until", type=float, help="begin no test after this time [s since 1970]")


@pytest.hookimpl(trylast=True)
def pytest_collection_modifyitems(config, items):
    first = len(items) * config.getoption("begin") // 100
    items[:] = items[first:] + items[:first]


def pytest_runtest_setup(item):
    until = item.config.getoption("until")
    if until is not None and time.time() > until:
        pytest.skip("the time of this run is over")


@pytest.fixture
def published(request):
    """Compare with a published number, and put it into the site's table where that is asked for."""
    return Published(request.node.nodeid)


# no deadlines: the first example of a test imports, and machines differ
settings.register_profile("plain", deadline=None)
settings.register_profile("ci", deadline=None, derandomize=True, print_blob=True)
settings.load_profile("ci" if os.environ.get("CI") else "plain")
