"""One to three decaying exponentials in moving windows of a complex signal, and the largest of them followed."""

from dataclasses import dataclass
from typing import Self

import numpy as np

from faying.errors import InputError
from faying.typing import Array, Complex, Index, Mask

ORDERS = (1, 2, 3)  # exponentials in a window
HOPS = 4  # windows begin a fourth of their length apart
LONGER = 1.5  # ratio of one length of window to the next that is tried
LEAST_WINDOWS = 5  # windows of one length
UNEXPLAINED = 0.001  # of the amplitude: joints do not follow exponentials more closely than this
BEAT = 2 * np.pi  # least distance of two poles times the window: a beat
ONE_IS_ENOUGH = 0.2  # share of the windows with more than one exponential up to which one is taken for all
NOISE_ALONE = 0.1  # of the power: noise beyond which the decay has ended
NOISE_AT_THE_END = 0.1  # noise over amplitude up to which an exponential is followed
NEAREST_WINDOWS = 7  # windows over which noise and scatter are averaged
MOST_SAMPLES = 10_000  # of a signal: a mode of 0.01 % in a band as wide as its frequency is down to 0.2 % then
PENCIL = 32  # greatest length of the pencil [samples]: least squares follow it
STEPS = 4  # of Gauss and Newton: from the poles of the pencil three reach six digits
SHORTER_STEP = 0.25  # of a step, after one that did not lower the residual
GREATEST_GROWTH = 30.0  # |ln| of the growth of an exponential within half a window: keeps trial steps finite
TINY = 1e-100  # next to the largest sample, 1: keeps silence finite
LEAST_SINGULAR_VALUE = 1e-13  # of normal equations, over the greatest: below it two exponentials are one


@dataclass(frozen=True, kw_only=True)
class Exponentials:
    """x(t) = sum over k of a_k exp(s_k t), times exp(b t^2) for the first, in w windows; t from the window's middle.

    The first is the largest at the start of its window. Its b follows a pole that changes at an even rate, 2 b.

    Attributes:
        pole, amplitude: s [1/sample] and a of each exponential (w, order).
        bend: b [1/sample^2] (w,).
        residual: mean square of what the sum leaves of the samples (w,).
        pole_variance, bend_variance: of s (w, order) and b (w,) over the variance of a sample, for white noise.
    """

    pole: Complex
    amplitude: Complex
    bend: Complex
    residual: Array
    pole_variance: Array
    bend_variance: Array

    @classmethod
    def fit(cls, windows: Complex, order: int) -> Self:
        """Fit so many exponentials to each of the windows (w, n), n at least twice the order plus one.

        Source:
            Hua and Sarkar 1990, doi:10.1109/29.56027 (matrix pencil, here by the right singular vectors).
        """
        t = np.arange(windows.shape[1]) - (windows.shape[1] - 1) / 2
        pole, bend = _pencil(windows, order), np.zeros(len(windows), complex)
        start = np.abs(cls._at(windows, pole, bend, t)[0].amplitude * np.exp(_within(pole * t[0])))
        pole = np.take_along_axis(pole, np.argsort(-start, axis=1), axis=1)
        best, step = cls._at(windows, pole, bend, t)
        for _ in range(STEPS):
            trial, further = cls._at(windows, best.pole + step[:, :order], best.bend + step[:, order], t)
            less = trial.residual < best.residual
            best, step = cls._choose(less, trial, best), np.where(less[:, None], further, SHORTER_STEP * step)
        return best

    def nearest(self) -> Array:
        """Least distance of two poles [1/sample] (w,), infinite for one."""
        order = self.pole.shape[1]
        away = np.abs(self.pole[:, :, None] - self.pole[:, None, :])
        return np.asarray(np.min(np.where(np.eye(order) > 0, np.inf, away), axis=(1, 2)))

    @classmethod
    def _at(cls, windows: Complex, pole: Complex, bend: Complex, t: Array) -> tuple[Self, Complex]:
        """Best amplitudes for given poles and bends, and the step of Gauss and Newton of poles and bend."""
        order = pole.shape[1]
        growth = _growth(pole, bend, t)
        amplitude = _least_squares(growth, windows)[0]
        part = amplitude[:, None, :] * growth
        rest = windows - part.sum(axis=2)
        slopes = np.concatenate([growth, t[:, None] * part, (t * t)[:, None] * part[:, :, :1]], axis=2)
        step, variance = _least_squares(slopes, rest)
        fit = cls(
            pole=pole,
            amplitude=amplitude,
            bend=bend,
            residual=np.mean(np.abs(rest) ** 2, axis=1),
            pole_variance=variance[:, order : 2 * order],
            bend_variance=variance[:, -1],
        )
        return fit, step[:, order:]

    @classmethod
    def _choose(cls, first: Mask, one: Self, other: Self) -> Self:
        """Values of `one` in the windows where `first`, else of `other`."""
        pairs = {name: (getattr(one, name), getattr(other, name)) for name in cls.__dataclass_fields__}
        return cls(**{n: np.where(first.reshape(-1, *[1] * (a.ndim - 1)), a, b) for n, (a, b) in pairs.items()})


@dataclass(frozen=True, kw_only=True)
class Windows:
    """Fits of one to three exponentials in all windows of one length.

    Attributes:
        size, hop: length of a window and distance of two [samples].
        fits: of each order.
        noise: variance of a sample that each order leaves (orders, w).
        strength: mean square of the samples (w,).
        share: independent samples among all.
    """

    size: int
    hop: int
    fits: list[Exponentials]
    noise: Array
    strength: Array
    share: float

    @classmethod
    def fit(cls, signal: Complex, size: int, share: float) -> Self:
        """Fit all windows of a signal (n,)."""
        hop, own = max(1, size // HOPS), size * share
        blocks = np.lib.stride_tricks.sliding_window_view(signal, size)[::hop]
        orders = [order for order in ORDERS if own - (2 * order + 1) >= 1 or order == 1]
        fits = [Exponentials.fit(blocks, order) for order in orders]
        noise = np.array([f.residual * own / max(own - 2 * k - 1, 1.0) for k, f in zip(orders, fits, strict=True)])
        strength = np.mean(np.abs(blocks) ** 2, axis=1)
        return cls(size=size, hop=hop, fits=fits, noise=noise, strength=strength, share=share)

    def cost(self, noise: float, samples: float) -> Array:
        """Schwarz's criterion: what each order leaves, over what noise may leave, plus parameters times ln(samples).

        Args:
            noise: variance of a sample of the record.
            samples: independent ones of the record.

        Returns:
            (orders, w), infinite where two poles are less than a beat apart.
        """
        own = self.size * self.share
        unknown = 4 * np.arange(1, len(self.fits) + 1)[:, None] + 2  # real and imaginary parts of s, a and the bend
        cost = 2 * own * self.noise / (noise + UNEXPLAINED**2 * self.strength + TINY) + unknown * np.log(2 * samples)
        cost[[fit.nearest() * self.size < BEAT for fit in self.fits]] = np.inf
        return np.asarray(cost)


@dataclass(frozen=True, kw_only=True)
class Track:
    """The exponential that is the largest at first, window by window (w,); time in samples from the signal's start.

    Attributes:
        time: of the middles of the windows.
        pole, bend, amplitude: s [1/sample], b [1/sample^2] and a at the middle, as of Exponentials.
        pole_error, bend_error: standard errors of real and imaginary part each, from the noise.
        noise: standard deviation of a sample.
    """

    time: Array
    pole: Complex
    bend: Complex
    amplitude: Complex
    pole_error: Array
    bend_error: Array
    noise: Array

    @classmethod
    def follow(cls, signal: Complex, shortest: int, share: float) -> Self | None:
        """Follow the largest exponential through windows of the length that describes the signal by fewest parameters.

        Short windows with one exponential describe a mode that changes with its amplitude, long ones with several
        describe modes that beat. Where one exponential is enough, the windows are the shortest.

        Args:
            signal: (n,) complex, of the order of 1.
            shortest: least length of a window [samples].
            share: independent samples among all, by the band of the signal.

        Returns:
            The track up to where it is lost, or None where noise is all that there is.

        Raises:
            InputError: a signal of more samples than any decay has.

        Source:
            Schwarz 1978, doi:10.1214/aos/1176344136 (the choice of length and order).
        """
        first = Windows.fit(signal, shortest, share)
        motion = np.flatnonzero(mean(np.min(first.noise, axis=0)) < NOISE_ALONE * mean(first.strength))
        if not len(motion):
            return None
        signal = signal[: motion[-1] * first.hop + shortest]
        if len(signal) > MOST_SAMPLES:
            raise InputError(
                f"the motion goes on for {len(signal):,} times one over the width of its band, a decay for at most "
                f"{MOST_SAMPLES:,}: narrow the band, or end the record with the decay"
            )
        whole = cls._best(signal, shortest, share)
        end = whole.time[max(int(np.argmin([*whole.clear(), False])), 1) - 1] + shortest / 2
        return cls._best(signal[: max(int(end), 2 * shortest)], shortest, share)

    def clear(self) -> Mask:
        """Whether the exponential stands clear of the noise (w,)."""
        return np.asarray(self.noise < NOISE_AT_THE_END * np.abs(self.amplitude))

    @classmethod
    def _best(cls, signal: Complex, shortest: int, share: float) -> Self:
        """Follow the largest exponential through windows of the best length for a whole signal."""
        tried, size = [Windows.fit(signal, shortest, share)], LONGER * shortest
        while size * (1 + (LEAST_WINDOWS - 1) / HOPS) <= len(signal):
            tried.append(Windows.fit(signal, int(size), share))
            size *= LONGER
        noise = min(float(np.median(np.min(windows.noise, axis=0))) for windows in tried)
        costs = [windows.cost(noise, share * len(signal)) for windows in tried]
        totals = [np.mean(np.min(cost, axis=0)) / windows.size for cost, windows in zip(costs, tried, strict=True)]
        best = int(np.argmin(totals))
        if np.mean(np.argmin(costs[best], axis=0) > 0) <= ONE_IS_ENOUGH:
            best = 0
        return cls._along(tried[best], np.argmin(costs[best], axis=0))

    @classmethod
    def _along(cls, windows: Windows, orders: Index) -> Self:
        """Take from each window the pole next to the last one, until none is within half a line of the spectrum."""
        noise = np.sqrt(mean(np.take_along_axis(windows.noise, orders[None], axis=0)[0]))
        rows: list[tuple[complex, complex, complex, float, float]] = []
        for at, order in enumerate(orders):
            fit = windows.fits[order]
            away = np.abs(fit.pole[at].imag - (rows[-1][0].imag if rows else fit.pole[at, 0].imag))
            k = int(np.argmin(away))
            if away[k] * windows.size > np.pi:
                break
            leads = float(k == 0)  # the others have no bend
            each = noise[at] / np.sqrt(2 * windows.share)  # real and imaginary part, white within the band
            error = each * np.sqrt(fit.pole_variance[at, k]), leads * each * np.sqrt(fit.bend_variance[at])
            rows.append((fit.pole[at, k], leads * fit.bend[at], fit.amplitude[at, k], *error))
        pole, bend, amplitude, pole_error, bend_error = (np.array(column) for column in zip(*rows, strict=True))
        return cls(
            time=np.arange(len(rows), dtype=float) * windows.hop + (windows.size - 1) / 2,
            pole=pole,
            bend=bend,
            amplitude=amplitude,
            pole_error=pole_error.real,
            bend_error=bend_error.real,
            noise=noise[: len(rows)],
        )


def mean(values: Array) -> Array:
    """Mean over the nearest windows (w,), fewer at the ends."""
    near = np.ones(min(NEAREST_WINDOWS, len(values)))
    return np.asarray(np.convolve(values, near, "same") / np.convolve(np.ones(len(values)), near, "same"))


def widened(errors: Array, values: Array) -> Array:
    """Standard errors (w,) of values, widened to how these scatter about a parabola through the nearest windows."""
    near = min(NEAREST_WINDOWS, len(values))
    wide = np.ones(len(values))
    for at in range(len(values) if near > 3 else 0):
        first = min(max(at - near // 2, 0), len(values) - near)
        own, x = slice(first, first + near), np.vander(np.arange(near), 3)
        weight = 1 / (errors[own] + TINY ** (1 / 4))
        rest = weight * (values[own] - x @ (np.linalg.pinv(weight[:, None] * x) @ (weight * values[own])))
        wide[at] = max(1.0, float(np.sqrt(rest @ rest / (near - 3))))
    return errors * wide


def _pencil(windows: Complex, order: int) -> Complex:
    """Poles [1/sample] (w, order): strongest right singular vectors V of the Hankel matrix H have V[1:] = V[:-1] Z.

    V are eigenvectors of H' H, whose diagonals are sums of products of samples that lie d apart.
    """
    count = windows.shape[1]
    length = min(count // 2, PENCIL)
    gram = np.zeros((len(windows), length + 1, length + 1), complex)
    for d in range(length + 1):
        sums = np.cumsum(np.pad(windows[:, : count - d].conj() * windows[:, d:], ((0, 0), (1, 0))), axis=1)
        i = np.arange(length + 1 - d)
        gram[:, i + d, i] = (sums[:, count - length :] - sums[:, : length + 1 - d]).conj()  # the lower half
    strongest = np.linalg.eigh(gram)[1][:, :, -order:].conj()
    ratio = np.linalg.eigvals(np.linalg.pinv(strongest[:, :-1]) @ strongest[:, 1:])
    return np.asarray(np.log(np.where(ratio == 0, TINY, ratio)))


def _within(power: Complex) -> Complex:
    return np.clip(power.real, -GREATEST_GROWTH, GREATEST_GROWTH) + 1j * power.imag


def _growth(pole: Complex, bend: Complex, t: Array) -> Complex:
    """exp(s_k t), the first times exp(b t^2) (w, n, order)."""
    power = pole[:, None, :] * t[:, None]
    power[:, :, 0] += bend[:, None] * t * t
    return np.exp(_within(power))


def _least_squares(columns: Complex, windows: Complex) -> tuple[Complex, Array]:
    """Least squares window by window: columns (w, n, m), windows (w, n); result and variance over a sample's (w, m)."""
    size = np.linalg.norm(columns, axis=1)
    scaled = columns / (size + TINY)[:, None, :]
    adjoint = np.swapaxes(scaled, 1, 2).conj()
    inverse = np.linalg.pinv(adjoint @ scaled, rcond=LEAST_SINGULAR_VALUE, hermitian=True)
    found = (inverse @ (adjoint @ windows[:, :, None]))[:, :, 0]
    variance = np.einsum("wkk->wk", inverse).real
    return found / (size + TINY), variance / (size + TINY) / (size + TINY)
