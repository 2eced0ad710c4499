"""FRFs from records in time: H1, H2, coherence (Bendat and Piersol, Random Data, 4th ed. 2010, doi:10.1002/9781118032428)."""

from typing import Any, Literal

import numpy as np

from faying.errors import InputError
from faying.measured.frf import FRF, Dof
from faying.typing import Array


def frf_from_records(
    force: Any,
    response: Any,
    sampling_rate: float,
    *,
    outputs: Any,
    input: Any = (1, "z"),
    quantity: str = "accelerance",
    estimator: Literal["H1", "H2"] = "H1",
    window: Literal["none", "hann", "exponential"] = "none",
    decay: float = 0.0,
) -> FRF:
    """FRFs of one input from the records of its hits (or of a stretch of random force each).

    force [N] (a, n); response (a, o, n), SI, of `quantity`'s kind: a records of n samples at `sampling_rate` [1/s] from o
    outputs. H1 = Sfx/Sff keeps clear of noise on the response, H2 = Sxx/Sxf of noise on the force; with noise-to-signal
    ratios q they come out as H/(1 + q_force) and H (1 + q_response) (Bendat and Piersol, section 6.1.4). The coherence
    |Sfx|2/(Sff Sxx) is 1 for a single record, and is then left out.

    window "exponential" multiplies force and response by exp(-decay t): every pole then moves left by exactly `decay`
    [1/s], which the FRF notes and the identification takes off again. "hann" is for random force.
    Raises InputError where shapes do not fit, a value is not finite, or a record of the force is empty.
    """
    f, x = np.asarray(force, float), np.asarray(response, float)
    places = tuple(Dof(*pair) for pair in outputs)
    if f.ndim != 2 or x.shape != (f.shape[0], len(places), f.shape[1]) or f.shape[1] < 8:
        raise InputError(
            f"force has the shape {f.shape} and response {x.shape}; give (records, samples) and (records, outputs, samples) "
            f"with {len(places)} outputs and 8 samples or more"
        )
    if not (np.all(np.isfinite(f)) and np.all(np.isfinite(x))):
        raise InputError("the records hold NaN or infinite values; leave such hits out")
    if not np.all(np.any(f != 0, axis=1)):
        raise InputError(
            f"the force of record {int(np.argmin(np.any(f != 0, axis=1))) + 1} is zero throughout; leave that hit out"
        )
    if not sampling_rate > 0:
        raise InputError(f"sampling_rate = {sampling_rate}: samples per second must be positive")
    if estimator not in ("H1", "H2"):
        raise InputError(f"estimator {estimator!r}: use H1 (noise on the response) or H2 (noise on the force)")
    if (window == "exponential") != (decay > 0):
        raise InputError('give decay > 0 [1/s] with window="exponential", and only then')
    weight = _window(window, f.shape[1], decay / sampling_rate)
    F, X = np.fft.rfft(f * weight), np.fft.rfft(x * weight)
    s_ff = np.mean(np.abs(F) ** 2, axis=0)
    s_xx = np.mean(np.abs(X) ** 2, axis=0)
    s_fx = np.mean(F[:, None].conj() * X, axis=0)
    with np.errstate(divide="ignore", invalid="ignore"):
        values = s_fx / s_ff if estimator == "H1" else s_xx / s_fx.conj()
        coherence = np.abs(s_fx) ** 2 / (s_ff * s_xx)
    keep = np.all(np.isfinite(values), axis=0)
    return FRF(
        frequency=np.asarray(np.fft.rfftfreq(f.shape[1], 1 / sampling_rate)[keep], np.float64),
        values=values[:, None, keep],
        outputs=places,
        inputs=(Dof(*input),),
        quantity=quantity,
        coherence=coherence[:, None, keep] if len(f) > 1 else None,
        window_decay=decay,
    )


def _window(name: str, n: int, decay: float) -> Array:
    if name == "none":
        return np.ones(n)
    if name == "exponential":
        return np.asarray(np.exp(-decay * np.arange(n)))
    if name == "hann":
        return np.asarray(np.sin(np.pi * np.arange(n) / n) ** 2)
    raise InputError(f'window {name!r}: use "none", "hann" or "exponential"')
