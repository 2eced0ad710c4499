"""FRFs from records in time: H1, H2, coherence (Bendat and Piersol, Random Data, 4th ed. 2010)."""

from typing import Any, Literal

import numpy as np

from faying.checks import number
from faying.errors import InputError
from faying.measured.frf import FRF, dofs
from faying.misuse import checked_call, numbers
from faying.typing import Array


@checked_call
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
    """Return the FRFs of one input from the records of its hits (or of a stretch of random force each).

    Args:
        force: [N], shape (records, samples), 8 samples or more.
        response: in the SI unit of `quantity`'s motion, shape (records, outputs, samples).
        sampling_rate: samples per second [1/s], positive.
        outputs: (point, direction) of each output.
        input: (point, direction) of the force.
        quantity: "receptance", "mobility" or "accelerance".
        estimator: "H1" = Sfx/Sff, H/(1 + q) for noise over signal q of the force, or "H2" = Sxx/Sxf, H (1 + q) for
            that of the response.
        window: "exponential" multiplies both by exp(-decay t), which moves every pole left by exactly `decay`; the
            identification takes it off again. "hann" is for random force.
        decay: of the exponential window [1/s], positive with it and 0 without.

    Returns:
        FRF of one input, with its coherence |Sfx|2/(Sff Sxx) where there are two records or more.

    Raises:
        InputError: where shapes do not fit, a value is not finite, or a record of the force is zero throughout.

    Source:
        Bendat and Piersol, doi:10.1002/9781118032428, section 6.1.4.
    """
    f, x = numbers(force, "force", "records", "samples"), numbers(response, "response", "records", "outputs", "samples")
    places, forced = dofs(outputs), dofs((input,))
    _check(f, x, len(places), sampling_rate)
    if estimator not in ("H1", "H2") or (window == "exponential") != (decay > 0):
        raise InputError(
            f"estimator = {estimator!r}, window = {window!r}, decay = {decay}: use H1 (noise on the response) or H2 "
            '(noise on the force); give decay > 0 [1/s] with window="exponential", and only then'
        )
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
        inputs=forced,
        quantity=quantity,
        coherence=coherence[:, None, keep] if len(f) > 1 else None,
        window_decay=decay,
    )


def _check(force: Array, response: Array, outputs: int, sampling_rate: float) -> None:
    if force.ndim != 2 or response.shape != (force.shape[0], outputs, force.shape[1]) or force.shape[1] < 8:
        raise InputError(
            f"force has the shape {force.shape} and response {response.shape}; give (records, samples) and (records, "
            f"outputs, samples) with {outputs} outputs and 8 samples or more"
        )
    if not (np.all(np.isfinite(force)) and np.all(np.isfinite(response))):
        raise InputError("the records have NaN or infinite values; leave such hits out")
    if not np.all(np.any(force != 0, axis=1)):
        empty = int(np.argmin(np.any(force != 0, axis=1))) + 1
        raise InputError(f"the force of record {empty} is zero throughout; leave that hit out")
    number(sampling_rate, "sampling_rate", "1/s", least=0)


def _window(name: str, n: int, decay: float) -> Array:
    k = np.arange(n)
    windows: dict[str, Array] = {
        "none": np.ones(n),
        "exponential": np.exp(-decay * k),
        "hann": np.sin(np.pi * k / n) ** 2,
    }
    if name not in windows:
        raise InputError(f'window {name!r}: use "none", "hann" or "exponential"')
    return windows[name]
