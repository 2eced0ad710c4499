"""Numbers of the bolts in the result: forces of modes and responses, strength, embedding, conductance, tables."""

import tomllib
from math import pi

import numpy as np
import pytest

from faying.answer.run import run
from faying.cli.run import text
from faying.output import report, table
from faying.result import Result
from faying.study import Study
from tests.helpers.results import small_result
from tests.helpers.studies import write

SHANK = {"diameter": "8 mm", "material": "45 steel", "grade": "8.8"}


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    folder = tmp_path_factory.mktemp("study")
    write(folder / "study.toml")

    def result(*, bolt, **changes):
        data = tomllib.loads((folder / "study.toml").read_text())
        data["geometry"]["size"] = "12 mm"
        data["geometry"].pop("face_size", None)
        data["bolt"][0] |= bolt
        data["modes"]["count"] = 4
        return run(Study.from_dict(data | changes, folder=folder))

    return result


@pytest.fixture(scope="module")
def tight(made):
    steel = {"E": "200 GPa", "nu": 0.3, "density": "7800 kg/m^3", "yield_strength": "355 MPa", "friction": 0.25}
    steel |= {"conductivity": "50 W/(m K)", "resistivity": "0.2 uohm m"}
    return made(
        bolt=SHANK | {"preload": ["6 kN"]},
        material={"steel": steel},
        part={name: {"material": "steel"} for name in ("upper", "lower")},
        response={
            "from": "100 Hz",
            "to": "16 kHz",
            "points": 60,
            "input": [{"point": ["40 mm", "15 mm", "15 mm"], "direction": [0, 0, 1]}],
            "output": [{"point": ["40 mm", "15 mm", "15 mm"], "direction": [0, 0, 1]}],
        },
    )


def test_the_shank_and_its_checks(tight):
    b = tight.bolt_numbers
    nominal, minor = pi / 4 * 8e-3**2, pi / 4 * (8e-3 - 1.22687 * 1.25e-3) ** 2
    delta = (0.9 * 8e-3 / nominal + (30e-3 + 4e-3) / minor) / 200e9  # head and nut; free and engaged thread
    assert b.compliance == pytest.approx(delta, rel=1e-6)
    proof = 580e6 * pi / 4 * (8e-3 - 0.938195 * 1.25e-3) ** 2
    assert b.proof_share == pytest.approx(6e3 / proof, rel=1e-4)
    assert b.seat_pressure == pytest.approx(6e3 / (pi * (8e-3**2 - 4.5e-3**2)), rel=2e-2)
    assert b.seat_limit == pytest.approx(355e6)
    assert b.load_factor == pytest.approx(b.member_compliance / (b.member_compliance + b.compliance), rel=1e-12)


def test_members_of_two_blocks_beside_the_cone(tight):
    """Their joint and the even pressure on the seats soften them: the guideline's discs are bonded, its heads stiff."""
    b = tight.bolt_numbers
    assert 1 < b.member_compliance[0, 0] / b.cone_compliance[0] < 1.5


def test_the_response_is_the_sum_of_the_modes(tight):
    """Of the bolt's force: modal force times motion of the driven place, over w_j^2 (1 + i eta_j) - w^2.

    Modes beyond the four that are known add what hardly changes over the band of the first two.
    """
    b, r = tight.bolt_numbers, tight.response
    assert r.bolt_forces.shape == (1, 60, 1, 1)
    node = int(np.argmin(np.linalg.norm(tight.outline - np.array([40e-3, 15e-3, 15e-3]), axis=1)))
    shape = tight.shapes[0].astype(float)
    most = np.linalg.norm(shape, axis=2).max(axis=1)
    residue = b.modal_force[0, :, 0] * most * shape[:, node, 2]
    band = (r.frequencies > 9e3) & (r.frequencies < 11e3)
    squared = (2 * pi * tight.frequencies[0]) ** 2 * (1 + 1j * tight.loss_factors[0])
    summed = (residue / (squared - (2 * pi * r.frequencies[band, None]) ** 2)).sum(axis=1)
    found = r.bolt_forces[0, band, 0, 0]
    rest = found - summed
    assert np.abs(rest - rest.mean()).max() < 0.05 * np.abs(found - found.mean()).max()


def test_force_per_acceleration_is_that_per_motion(tight):
    b = tight.bolt_numbers
    omega = 2 * pi * tight.frequencies[:, :, None]
    assert b.modal_force_by_acceleration * omega**2 == pytest.approx(b.modal_force, rel=1e-12)


def test_conductance_is_that_of_the_springs(tight):
    """Both faces of steel: h = k_n K/E* and k_n/(E* rho)."""
    E_star = 200e9 / (2 * (1 - 0.3**2))
    k_n = tight.k_n @ tight.weights
    assert tight.thermal_conductance[:, 0] == pytest.approx(k_n * 50 / E_star, rel=1e-12)
    assert tight.electrical_conductance[:, 0] == pytest.approx(k_n / (E_star * 0.2e-6), rel=1e-12)


def test_an_elastic_law_predicts_no_embedding(tight):
    b = tight.bolt_numbers
    assert np.isnan(b.embedding).all()
    assert np.isnan(b.embedding_loss).all()
    assert np.isnan(b.embedding_guide).all()  # no scan, no Rz


def test_tables_and_files(tight, tmp_path):
    rows = table.bolting(tight)
    assert "Phi" in rows[0]
    assert "embedding [um]" not in rows[0]
    assert rows[1][1] == "bolt"
    assert table.conductance(tight)[0] == ["preload", "joint [W/K]", "joint [S]"]
    head = "bolts and what they clamp (no law here has a loading curve of its own: no embed"
    assert head in " ".join(text(tight).split())
    assert "<h3>Conductance of the joints</h3>" in report.html(tight)
    assert Result.load(tight.save(tmp_path / "result.nc")) == tight
    out = tight.to_dict()["bolt_numbers"]
    assert out["load_factor"] == {"unit": "1", "values": tight.bolt_numbers.load_factor.tolist()}
    assert out["embedding_loss"]["values"] == [[[None]], [[None]]]
    assert (
        table.bolting(small_result()) == table.modal_forces(small_result()) == table.conductance(small_result()) == []
    )


@pytest.fixture(scope="module")
def loose(made, tmp_path_factory):
    """A bolt that is a force, on a scan with a law that yields."""
    from faying.surface.files.write import write_scan
    from faying.surface.scan import Scan
    from faying.surface.synthesize import spectral

    scan = spectral((96, 96), spacing=5e-6, D=2.2, Rq=1e-6, longest=1e-4, seed=7)
    assert isinstance(scan, Scan)
    file = write_scan(scan, tmp_path_factory.mktemp("scan") / "s.x3p", precision="F")
    return made(
        bolt={"preload": ["6 kN"]},
        surface={"scan": str(file)},
        law={"model": "half-space", "points": 5},
    )


def test_a_force_alone_has_members_and_embedding_but_no_loss(loose):
    b = loose.bolt_numbers
    assert np.isnan(b.compliance).all()
    assert np.isnan(b.load_factor).all()
    assert np.isnan(b.modal_force).all()
    assert np.isnan(b.embedding_loss).all()
    assert np.all(b.member_compliance > 0)
    assert np.isnan(b.proof_share).all()
    least, greatest = b.embedding[:, 0, 0, 0]
    assert "bolts and what they clamp\n" in text(loose)
    assert "embedding [um]" in table.bolting(loose)[0]
    assert 0 < least <= greatest < 20e-6


def test_the_guide_value_counts_thread_seats_and_joint(loose):
    """Rz of this scan is below 10 um: 3 + 2 x 2.5 + 1.5 um."""
    assert loose.bolt_numbers.embedding_guide == pytest.approx(9.5e-6)
