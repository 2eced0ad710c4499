"""Poles over rising order (through sdypy-EMA), and the rule by which those that stay become modes."""

import warnings
from dataclasses import dataclass
from typing import Any, Self

import numpy as np

from faying.errors import InputError
from faying.measured.frf import FRF
from faying.measured.lsfd import compressed, residues
from faying.measured.mac import mac
from faying.typing import Array, Complex, Index

NOISE = 1e-9  # of the greatest value


@dataclass(frozen=True, kw_only=True)
class Rule:
    """What makes a pole stable, and a row of stable poles a mode.

    Poles are computed at orders 1, 2, ... highest_order (number of modes in the polynomial). Those with damping ratio
    between 0 and highest_damping whose frequency lies in the band are kept. A pole continues a track when it differs
    from the track's last pole by less than `frequency` and `damping` (both relative) and the MAC of their residues
    exceeds `mac`; each pole continues one track and each track takes one pole of an order, the nearest in the sum. A
    track ends when `gap` orders in a row do not continue it. A mode is a track of at least `orders` poles.
    """

    highest_order: int = 80
    frequency: float = 0.01
    damping: float = 0.05
    mac: float = 0.95
    gap: int = 3
    orders: int = 16
    highest_damping: float = 0.2

    @classmethod
    def fitting(cls, lines: int, *, highest_order: int | None = None, orders: int | None = None) -> Self:
        """The rule for FRFs of so many spectral lines: an order for eight, 80 at most; a mode stays over a fifth."""
        highest = highest_order or max(4, min(cls.highest_order, lines // 8))
        return cls(highest_order=highest, orders=orders or max(3, highest // 5))

    def __post_init__(self) -> None:
        if not 1 <= self.orders <= self.highest_order:
            raise InputError(
                f"orders = {self.orders} of highest_order = {self.highest_order}: a mode must be able to reach "
                "the number of orders asked of it; lower orders or raise highest_order"
            )
        if not (
            self.frequency > 0 and self.damping > 0 and 0 <= self.mac < 1 and self.gap >= 1 and self.highest_damping > 0
        ):
            raise InputError(f"{self}: tolerances must be positive, mac from 0 to below 1, gap 1 or more")


@dataclass(frozen=True, kw_only=True)
class Poles:
    """Poles of all orders in one row: order (p,), frequency [Hz], damping ratio [-], track (p,): the mode, or -1."""

    order: Index
    frequency: Array
    damping: Array
    track: Index


def poles_by_order(frf: FRF, highest_order: int) -> list[Complex]:
    """Poles [rad/s] of orders 1 to highest_order, those with positive frequency, by least-squares complex frequency.

    LSCF of sdypy-EMA (Guillaume et al. 2003; Verboven 2002), without its windows. The spectral lines must be evenly
    spaced and at multiples of their spacing, else InputError.
    """
    step = frf.whole_step
    lines = round(frf.frequency[0] / step)
    rows = compressed(frf.rows(), 2 * highest_order)
    if len(rows[0]) < 4 * highest_order:
        raise InputError(
            f"{len(rows[0])} spectral lines are too few for order {highest_order}; widen the band or take an order of "
            f"at most {len(rows[0]) // 4}"
        )
    # zeros below the band and one more line above, which the library cuts off again
    rows = np.concatenate([np.zeros((len(rows), lines)), rows, rows[:, -1:]], axis=1)
    frequency = np.arange(rows.shape[1]) * step
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        from sdypy import EMA

        rows = rows / np.abs(rows).max()
        noise = NOISE * np.random.default_rng(1).standard_normal(rows.shape)
        # without any noise a few modes leave nothing to poles of high order, and rounding says whether that is singular
        for given in (rows, rows + noise):
            band = {"lower": max(lines, 1) * step, "upper": frequency[-1], "frf_form": frf.quantity}
            model: Any = EMA.Model(given, frequency, pol_order_high=highest_order, **band)
            try:
                model.get_poles(method="lscf", show_progress=False)
                break
            except np.linalg.LinAlgError as fault:
                if given is not rows:
                    text = f"no poles of order {highest_order} ({fault}): the FRFs are zero; lower the order"
                    raise InputError(text) from None
    found = [np.asarray(p, complex) for p in model.all_poles]
    return [p[np.isfinite(p) & (p.imag > 0)] for p in found]


def tracks(frf: FRF, by_order: list[Complex], rule: Rule) -> tuple[Poles, list[Complex]]:
    """Apply the rule: all poles with their track, and the poles of each track, tracks rising in frequency."""
    from scipy.optimize import linear_sum_assignment

    rows = compressed(frf.rows(), 2 * rule.highest_order)
    last: list[tuple[complex, Complex, int]] = []  # pole, residues, order of the end of each track
    members: list[list[tuple[int, int]]] = []
    table: list[tuple[int, complex]] = []
    for order, found in enumerate(by_order, start=1):
        f, z = np.abs(found) / (2 * np.pi), -found.real / np.abs(found)
        kept = found[(z > 0) & (z < rule.highest_damping) & (f >= frf.frequency[0]) & (f <= frf.frequency[-1])]
        if not len(kept):
            continue
        shapes = residues(kept, frf.frequency, rows, frf.quantity)[0]
        live = [t for t, end in enumerate(last) if order - end[2] <= rule.gap]
        chosen: dict[int, int] = {}
        if live:
            cost = _distance(kept, shapes, [last[t] for t in live], rule)
            for p, t in zip(*linear_sum_assignment(np.minimum(cost, 1e3)), strict=True):
                if np.isfinite(cost[p, t]):
                    chosen[int(p)] = live[int(t)]
        for p, pole in enumerate(kept):
            t = chosen.get(p, len(last))
            if t == len(last):
                last.append((pole, shapes[p], order))
                members.append([])
            last[t] = (pole, shapes[p], order)
            members[t].append((order, len(table)))
            table.append((order, pole))
    good = [[row for _, row in track] for track in members if len(track) >= rule.orders]
    good.sort(key=lambda track: float(np.median([abs(table[row][1]) for row in track])))
    poles = np.array([pole for _, pole in table], complex)
    number = np.full(len(table), -1)
    for k, track in enumerate(good):
        number[track] = k
    return (
        Poles(
            order=np.array([o for o, _ in table], dtype=np.int64),
            frequency=np.abs(poles) / (2 * np.pi),
            damping=-poles.real / np.maximum(np.abs(poles), 1e-300),
            track=number,
        ),
        [poles[track] for track in good],
    )


def _distance(poles: Complex, shapes: Complex, ends: list[tuple[complex, Complex, int]], rule: Rule) -> Array:
    """Sum of the differences over their tolerances (poles, tracks); infinite where the rule does not allow the step."""
    end = np.array([e[0] for e in ends])
    df = np.abs(np.abs(poles)[:, None] / np.abs(end) - 1) / rule.frequency
    z, ze = -poles.real / np.abs(poles), -end.real / np.abs(end)
    dz = np.abs(z[:, None] / ze - 1) / rule.damping
    dm = (1 - mac(shapes, np.array([e[1] for e in ends]))) / (1 - rule.mac)
    return np.where((df < 1) & (dz < 1) & (dm < 1), df + dz + dm, np.inf)
