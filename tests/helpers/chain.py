"""Masses between springs, two of which stiffen with preload as a joint does: a model that is evaluated in no time."""

import numpy as np

from faying.distribution import Distribution
from faying.identify.identify import Model

LOADS = np.array([4e3, 8e3, 12e3])


class Chain(Model):
    """Contacts of stiffness c (F/10 kN)^n between bodies whose mass has a scale; one parameter does nothing."""

    names = ("contact.c", "contact.n", "mass.scale", "unseen")
    units = ("N/m", "", "", "Pa")
    priors = (
        Distribution(kind="lognormal", centre=1e7, spread=0.5),
        Distribution(kind="uniform", centre=0.5, spread=0.4),
        Distribution(kind="normal", centre=1, spread=0.02),
        Distribution(kind="normal", centre=2e11, spread=4e9),
    )

    def __init__(self, loads=LOADS):
        self.loads, self.evaluated = np.asarray(loads), 0

    def frequencies(self, values, report=None, allowed=0.0):
        self.evaluated += len(values)
        c, n, scale = values[:, :3].T[..., None]
        contact = c * (self.loads / 1e4) ** n
        k = np.stack(np.broadcast_arrays(1e7, contact, 2e7, 1.5 * contact, 1.5e7), axis=-1) / scale[..., None]
        matrix = np.zeros((*contact.shape, 4, 4))
        j = np.arange(4)
        matrix[..., j, j] = k[..., :-1] + k[..., 1:]
        matrix[..., j[1:], j[:-1]] = matrix[..., j[:-1], j[1:]] = -k[..., 1:-1]
        return np.sqrt(np.linalg.eigvalsh(matrix)) / (2 * np.pi), [""] * len(values)


class DampedChain(Chain):
    """A chain whose contacts lose a share of what they store; the frequencies do not see how large it is."""

    names = (*Chain.names[:3], "contact.loss")
    units = ("N/m", "", "", "")
    priors = (*Chain.priors[:3], Distribution(kind="lognormal", centre=0.02, spread=1.0))

    def frequencies(self, values, report=None, allowed=0.0):
        f, reasons = super().frequencies(values)
        stiffer = values.copy()
        stiffer[:, 0] *= 1.001
        # share of the contacts in the energy of each mode, by what their stiffness changes
        share = 2 * np.log(super().frequencies(stiffer)[0] / f) / np.log(1.001)
        return np.concatenate([f, values[:, 3, None, None] * share], axis=2), reasons


class Linear(Model):
    """ln f linear in normal parameters: ln f[load, mode] = ln 100 + slopes[load, mode] . (x - 1)/0.1."""

    def __init__(self, slopes, kind="normal", priors=None):
        self.slopes = np.asarray(slopes)
        size = self.slopes.shape[-1]
        self.names = tuple(f"x{k + 1}" for k in range(size))
        self.units = ("",) * size
        self.priors = priors or tuple(Distribution(kind=kind, centre=1, spread=0.1) for _ in range(size))

    def logs(self, values):
        return np.log(100) + np.einsum("lmd,nd->nlm", self.slopes, (values - 1) / 0.1)

    def frequencies(self, values, report=None, allowed=0.0):
        return np.exp(self.logs(values)), [""] * len(values)


class Altered(Model):
    """A model whose frequencies, reasons or logs a function changes."""

    def __init__(self, model, change):
        self.model, self.change = model, change
        self.names, self.units, self.priors = model.names, model.units, model.priors

    def frequencies(self, values, report=None, allowed=0.0):
        return self.change(values, *self.model.frequencies(values))
