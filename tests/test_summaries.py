"""What a notebook prints of an object: a heading and a few lines, never its arrays."""

from pathlib import Path

import numpy as np
import pytest

import faying
from faying.study import Study
from tests.helpers.figures import hammer, measured_points

EXAMPLES = Path(__file__).parents[1] / "examples"
BLOCKS = EXAMPLES / "two-blocks"


def uff():
    return faying.read_uff(EXAMPLES / "hammer-test" / "blocks.uff")


def attached():
    study = BLOCKS / "study.toml"
    return faying.attach(BLOCKS / "model.inp", ("FACE_A", "FACE_B"), unit="mm", study=study, pressure="5 MPa")


def places():
    return np.stack(np.meshgrid(np.linspace(0, 0.04, 9), np.linspace(0, 0.02, 5)), axis=-1).reshape(-1, 2)


MADE = {
    "Universal file": (uff, ("functions", "blocks.uff")),
    "FRF": (lambda: uff().frf(), ("accelerance", "lines", "Hz")),
    "Identified": (lambda: faying.identify_modes(uff().frf()), ("mode 1", "fit leaves")),
    "ModeSet": (lambda: hammer().test, ("mode 1", "loss factor")),
    "ModelModes": (lambda: hammer().model, ("kN", "frequencies")),
    "ModalComparison": (hammer, ("pairs", "MAC")),
    "MeasuredBackbone": (measured_points, ("m/s2", "%")),
    "GapMap": (lambda: faying.GapMap(places=places(), gaps=1e-6 * np.arange(45.0)), ("40 x 20 mm", "0 to 44 um")),
    "FaceMap": (lambda: faying.FaceMap(places=places(), heights=1e-6 * np.arange(45.0)), ("45 points",)),
    "GeometryFacts": (lambda: faying.faces(BLOCKS / "model.inp", unit="mm"), ("2 parts", "faces,")),
    "Attachment": (lambda: attached(), ("pairs", "N/m")),
    "Study": (lambda: Study.read(EXAMPLES / "hammer-test" / "study.toml"), ("upper (45 steel)", "2, 6 kN", "test")),
}


@pytest.mark.parametrize("name", MADE)
def test_a_summary_is_short_and_says_what_there_is(name):
    make, words = MADE[name]
    made = make()
    text = repr(made)
    assert 2 <= len(text.splitlines()) <= 12
    assert len(text) < 1200
    assert "array(" not in text
    assert [word for word in words if word not in text] == []
    assert "<table>" in made._repr_html_()
