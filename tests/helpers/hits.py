"""The FRF of one hit, from its records in time."""

import numpy as np

from faying import FRF


def frf_of_hit(force, response, rate, quantity, decay=0.0):
    """Force and response (n,) under a window exp(-decay t); rate: samples per second."""
    window = np.exp(-decay * np.arange(len(force)) / rate)
    return FRF(
        frequency=np.fft.rfftfreq(len(force), 1 / rate),
        values=(np.fft.rfft(response * window) / np.fft.rfft(force * window))[None, None],
        outputs=[(1, "z")],
        inputs=[(1, "z")],
        quantity=quantity,
        window_decay=decay,
    )
