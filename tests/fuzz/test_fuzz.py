"""No reader answers a damaged file with a traceback, a signal, a hang or a flood of memory."""

import pytest

from tests.fuzz.harness import run
from tests.fuzz.seeds import written

HEAVY = ("attach", "condense", "body")  # whole commands, which the slow tests and the harness run


@pytest.fixture(scope="module")
def seeds(tmp_path_factory):
    folder = tmp_path_factory.mktemp("fuzz")
    return folder, written(folder)


def test_every_seed_is_valid(seeds):
    from tests.fuzz.child import READERS

    _, files = seeds
    assert {reader for reader, _ in files} == set(READERS)
    for reader, path in files:
        assert READERS[reader](str(path)) > 0


def test_300_mutated_inputs_are_read_or_refused_in_words(seeds):
    folder, files = seeds
    answers = run([one for one in files if one[0] not in HEAVY], folder, 300, seed=20)
    assert [a for a in answers if a.bad] == []
    assert all(len(a.text) > 20 for a in answers if a.outcome == "refused")
    assert sum(a.outcome == "refused" for a in answers) > 100  # the mutations do harm


@pytest.mark.slow
def test_200_mutated_inputs_of_whole_commands(seeds):
    folder, files = seeds
    assert [a for a in run([one for one in files if one[0] in HEAVY], folder, 200, seed=50) if a.bad] == []


@pytest.mark.slow
@pytest.mark.parametrize("seed", [31, 32])
def test_2000_mutated_inputs_are_read_or_refused_in_words(seeds, seed):
    folder, files = seeds
    assert [a for a in run(files, folder, 1000, seed=seed) if a.bad] == []
