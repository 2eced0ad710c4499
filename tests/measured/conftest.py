import os
from pathlib import Path

import numpy as np
import pytest

from faying.measured.frf import FRF, QUANTITIES

ROOT = Path(__file__).parents[2]


@pytest.fixture(scope="session")
def measured_frfs():
    """The folder of real FRFs; FAYING_DATA, or ../shared/data beside the repository."""
    folder = Path(os.environ.get("FAYING_DATA", ROOT / "../shared/data")) / "frf"
    if not folder.is_dir():
        pytest.skip(f"real FRFs are absent: {folder}; set FAYING_DATA")
    return folder


def receptance(frequency, modes, shapes_out, shapes_in):
    """Receptance (o, i, f) of viscously damped modes [(Hz, ratio)] with mass-normalised shapes (m, o), (m, i)."""
    w = 2 * np.pi * frequency
    total = 0
    for (f, z), o, i in zip(modes, shapes_out, shapes_in, strict=True):
        wr = 2 * np.pi * f
        total = total + np.multiply.outer(np.outer(o, i), 1 / (wr**2 - w**2 + 2j * z * wr * w))
    return total


@pytest.fixture
def synthetic():
    """A maker of FRFs of known modes, with noise of a share of the FRFs' rms, and the shapes behind them."""

    def make(modes, *, step=1.0, last=1000.0, outputs=8, inputs=1, noise=0.0, quantity="accelerance", seed=0):
        rng = np.random.default_rng(seed)
        shapes = rng.standard_normal((len(modes), max(outputs, inputs)))
        shapes[:, 0] = 1  # every mode is driven
        frequency = np.arange(0, last + step / 2, step)
        values = receptance(frequency, modes, shapes[:, :outputs], shapes[:, :inputs])
        values = values * (2j * np.pi * frequency) ** QUANTITIES[quantity]
        size = noise * np.sqrt(np.mean(np.abs(values) ** 2)) / np.sqrt(2)
        values = values + size * (rng.standard_normal(values.shape) + 1j * rng.standard_normal(values.shape))
        frf = FRF(
            frequency=frequency,
            values=values,
            outputs=[(k + 1, "z") for k in range(outputs)],
            inputs=[(k + 1, "z") for k in range(inputs)],
            quantity=quantity,
        )
        return frf, shapes

    return make
