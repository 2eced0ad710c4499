"""Killed commands lose nothing, leave no worker, and write nothing that cannot be read."""

from pathlib import Path

import pytest

from tests.fuzz.kills import Kill, campaign


@pytest.mark.slow
@pytest.mark.skipif(not Path("/proc").is_dir(), reason="looks for processes in /proc")
def test_20_kills_over_all_commands_and_two_of_each_at_once(tmp_path):
    found = list(campaign(tmp_path, 20, seed=3))
    assert len([one for one in found if isinstance(one, Kill)]) == 20
    assert [one for one in found if not isinstance(one, Kill) or one.fault] == []
