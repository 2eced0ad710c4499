"""One study has one answer, whatever memory is free."""

import pytest

from faying.fe.solve import available
from faying.study import Study, run
from tests.helpers import studies

pytestmark = pytest.mark.skipif("pardiso" not in available(), reason="only PARDISO factorises part by part")


@pytest.fixture(scope="module")
def study(tmp_path_factory):
    """Two blocks and a bolt."""
    path = tmp_path_factory.mktemp("engines") / "study.toml"
    studies.write(path)
    one = path.read_text().replace('["2 kN", "6 kN"]', '"6 kN"')
    path.write_text(one)
    return Study.read(path)


@pytest.fixture(scope="module")
def plenty(study):
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("FAYING_MEMORY", "inf")
        return run(study)


@pytest.mark.parametrize("gigabytes", ["0.08", pytest.param("0.12", marks=pytest.mark.slow)])
def test_free_memory_decides_nothing(study, plenty, gigabytes, monkeypatch):
    monkeypatch.setenv("FAYING_MEMORY", gigabytes)
    short = run(study)
    assert short.solver == "pardiso-by-parts"
    for name in ("frequencies", "free", "bonded"):
        assert getattr(short, name) == pytest.approx(getattr(plenty, name), rel=1e-8), name
    assert short.pressure == pytest.approx(plenty.pressure, abs=1e-7 * plenty.pressure.max())
    assert short.loss_factors == pytest.approx(plenty.loss_factors, rel=1e-6)
    assert short.notes == plenty.notes
