"""The study that exports are tested on."""

import pytest

from tests.helpers.studies import write_coarse


@pytest.fixture(scope="module")
def file(tmp_path_factory):
    path = tmp_path_factory.mktemp("study") / "study.toml"
    write_coarse(path)
    return path
