import os
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]


@pytest.fixture(scope="session")
def scans():
    """The folder of real scans; FAYING_DATA, or ../shared/data beside the repository."""
    folder = Path(os.environ.get("FAYING_DATA", ROOT / "../shared/data")) / "scans"
    if not folder.is_dir():
        pytest.skip(f"real scans are absent: {folder}; set FAYING_DATA")
    return folder
