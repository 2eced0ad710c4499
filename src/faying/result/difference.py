"""Two results of one structure compared: which mode is which, and how frequencies, losses and pressures differ."""

from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from faying.joint.preload_case import preload_index
from faying.measured.mac import mac
from faying.misuse import checked_call
from faying.numerics.follow import partners
from faying.result.result import Result
from faying.style import SOFT, WIDE, Summary, colour, drawing, new_figure, plain_numbers, shared_legend
from faying.text import csv_text, few, in_columns
from faying.typing import Array, Index
from faying.units import load_text

ALIKE = 0.5  # MAC that a pair of modes must have
APART = 0.05  # of the size of the structure, how far nodes of two meshes may lie apart to stand for each other
NEIGHBOURS = 4  # nodes of the other mesh that give its motion at a point
SAME_LOAD = 1e-6  # relative difference of preloads that count as one
Rows = list[list[str]]


@checked_call
@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class RunDifference(Summary):
    """How the second of two results differs from the first.

    Args:
        first, second: the results.
        loads: index of the preload of each that is compared.
        modes: (pair, 2) index of each mode in the first and in the second result.
        mac: (pair,) likeness of the two shapes [-], NaN where modes are paired by their number.
        notes: what does not compare.
    """

    first: Result
    second: Result
    loads: tuple[int, int]
    modes: Index
    mac: Array
    notes: tuple[str, ...] = ()

    @property
    def frequency_change(self) -> Array:
        """(pair,) frequency of the second over that of the first, less 1 [-]."""
        first, second = self.frequencies
        return np.asarray(second / first - 1.0)

    @property
    def frequencies(self) -> tuple[Array, Array]:
        """(pair,) frequencies of both [Hz]."""
        return self._of_modes("frequencies")

    @property
    def loss_factors(self) -> tuple[Array, Array]:
        """(pair,) loss factors of both [-]."""
        return self._of_modes("loss_factors")

    @property
    def preloads(self) -> tuple[float, float]:
        """Preload of the first bolt in both [N]."""
        return float(self.first.loads[self.loads[0]]), float(self.second.loads[self.loads[1]])

    def summary(self) -> tuple[str, dict[str, str]]:
        """Return a heading and the changes of the modes."""
        change = [
            f"mode {i + 1}: {100 * one:+.2f} %" for (i, _), one in zip(self.modes, self.frequency_change, strict=True)
        ]
        rows = {
            "first": f"{self.first.title}, {load_text(self.preloads[0])}",
            "second": f"{self.second.title}, {load_text(self.preloads[1])}",
            "frequency": few(change, 8) or "no modes alike",
        }
        return "Difference of two runs", rows | {f"note {k}": text for k, text in enumerate(self.notes[:8], start=1)}

    def to_dict(self) -> dict[str, Any]:
        """The comparison as plain lists in SI units: preloads, pairs of modes, numbers of the joints, notes."""
        f, loss = self.frequencies, self.loss_factors
        return {
            "preloads": list(self.preloads),
            "modes": [
                {
                    "first": int(i) + 1,
                    "second": int(j) + 1,
                    "frequencies": [float(one[k]) for one in f],
                    "loss_factors": [float(one[k]) for one in loss],
                    "mac": float(self.mac[k]),
                }
                for k, (i, j) in enumerate(self.modes)
            ],
            "joints": {name: [asdict(one) for one in self.of_joint(name)] for name in self.joints},
            "notes": list(self.notes),
        }

    def csv_text(self) -> str:
        """The pairs of modes as CSV, SI, units in the heading."""
        sides = [f"{which} {what}" for what in ("frequency [Hz]", "loss factor [-]") for which in ("first", "second")]
        columns = zip(self.modes + 1, *self.frequencies, *self.loss_factors, self.mac, strict=True)
        rows = ([*pair, *map(float, numbers)] for pair, *numbers in columns)
        return csv_text([["first mode", "second mode", *sides, "MAC [-]"], *rows])

    def of_joint(self, name: str) -> "tuple[JointNumbers, JointNumbers]":
        """Numbers of a joint in both."""
        first, second = self.loads
        return (
            of_joint(self.first, first, self.first.joints.index(name)),
            of_joint(self.second, second, self.second.joints.index(name)),
        )

    @property
    def joints(self) -> tuple[str, ...]:
        """Names of the joints that both have."""
        return tuple(name for name in self.first.joints if name in self.second.joints)

    def _of_modes(self, name: str) -> tuple[Array, Array]:
        (first, second), (own, other) = self.loads, self.modes.T
        return getattr(self.first, name)[first][own], getattr(self.second, name)[second][other]

    def mode_rows(self) -> Rows:
        """One row for each pair of modes, with a head."""
        (first, second), (loss, other) = self.frequencies, self.loss_factors
        change = 100 * (np.divide(other, loss, out=np.full_like(loss, np.nan), where=loss > 0) - 1)
        return in_columns(
            ("mode", [f"{i + 1}" if i == j else f"{i + 1}, {j + 1}" for i, j in self.modes], ""),
            ("first [Hz]", first, ".2f"),
            ("second [Hz]", second, ".2f"),
            ("by [%]", 100 * self.frequency_change, "+.2f"),
            ("first loss", loss, ".3g"),
            ("second loss", other, ".3g"),
            ("by [%]", change, "+.1f"),
            ("MAC", self.mac, ".3f"),
        )

    def joint_rows(self) -> Rows:
        """Rows for each joint that both have, with a head: mean and greatest pressure, open share, stiffness."""
        rows = [["joint", "what", "first", "second", "change"]] if self.joints else []
        for name in self.joints:
            first, second = self.of_joint(name)
            for what, unit, scale, form in (
                ("mean", "mean pressure [MPa]", 1e-6, ".3g"),
                ("greatest", "greatest pressure [MPa]", 1e-6, ".3g"),
                ("open_share", "open share of the area [%]", 100.0, ".1f"),
                ("stiffness", "total k_n [N/m]", 1.0, ".4g"),
            ):
                a, b = scale * getattr(first, what), scale * getattr(second, what)
                relative = f"{100 * (b / a - 1):+.1f} %" if a > 0 else "-"
                change = f"{b - a:+.1f} points" if what == "open_share" else relative
                rows.append([name, unit, f"{a:{form}}", f"{b:{form}}", change])
        return rows


@dataclass(frozen=True, kw_only=True)
class JointNumbers:
    """One joint at one preload: pressures [Pa], mean over the nominal area; open share of the area [-]; k_n [N/m]."""

    mean: float
    greatest: float
    open_share: float
    stiffness: float


def of_joint(result: Result, load: int, joint: int) -> JointNumbers:
    """Return the numbers of one joint at one preload."""
    here = result.joint_of_point == joint
    weights, pressure = result.weights[here], result.pressure[load][here]
    area = float(weights.sum())
    return JointNumbers(
        mean=float(weights @ pressure) / area,
        greatest=float(pressure.max()),
        open_share=float(weights @ (pressure <= 0)) / area,
        stiffness=float(result.total_k_n[load, joint]),
    )


@checked_call
def compare_runs(first: Result, second: Result, preload: float | str | None = None) -> RunDifference:
    """Compare two results of one structure, which may differ in law, surface, bolts, materials and mesh.

    Modes are paired by the likeness of their shapes over the area of the outer surface. At the nodes of the first mesh
    another mesh moves as its four nearest nodes do, weighted by 1 over the square of their distance. All pairs together
    have the greatest sum of MAC, and each has at least 0.5. Where the surfaces lie apart modes are paired by their
    number.

    Args:
        first: the result that differences are counted from.
        second: the other.
        preload: of both [N], or text with a unit; the last that both have where None, else the last of each.

    Returns:
        The comparison; `shared_preloads` says at which others the two may be compared.

    Raises:
        InputError: a result has no such preload.
    """
    notes = []
    if preload is not None:
        loads = (
            preload_index(first.loads, preload, names=first.load_names, of="the first run"),
            preload_index(second.loads, preload, names=second.load_names, of="the second run"),
        )
    else:
        shared = shared_preloads(first, second)
        loads = shared[-1] if shared else (len(first.loads) - 1, len(second.loads) - 1)
    at = first.loads[loads[0]], second.loads[loads[1]]
    if abs(at[1] - at[0]) > SAME_LOAD * at[0]:
        notes.append(f"the preloads differ: {load_text(at[0])} in the first run, {load_text(at[1])} in the second")
    elif first.load_names[loads[0]] != second.load_names[loads[1]]:
        here, there = first.load_names[loads[0]], second.load_names[loads[1]]
        notes.append(f"the joints have not carried the same: {here!r} in the first run, {there!r} in the second")
    modes, alike, why = _paired(first, second, loads)
    if why:
        notes.append(why)
    for one, other, which, side in ((first, second, "first", 0), (second, first, "second", 1)):
        alone = [name for name in one.joints if name not in other.joints]
        if alone:
            notes.append(f"only the {which} run has the joints {', '.join(alone)}")
        left = sorted(set(range(one.frequencies.shape[1])) - set(modes[:, side].tolist()))
        if left:
            listed = ", ".join(f"{k + 1} ({one.frequencies[loads[side], k]:.0f} Hz)" for k in left)
            notes.append(f"modes of the {which} run without a partner: {listed}")
    return RunDifference(first=first, second=second, loads=loads, modes=modes, mac=alike, notes=tuple(notes))


def shared_preloads(first: Result, second: Result) -> list[tuple[int, int]]:
    """Where the preloads stand that both results have, from the least: index in the first and in the second."""
    same = np.argwhere(np.isclose(first.loads[:, None], second.loads[None], rtol=SAME_LOAD, atol=0))
    pairs = [(int(i), int(j)) for i, j in same]
    return [(i, j) for i, j in pairs if first.load_names[i] == second.load_names[j]] or pairs


def _areas(result: Result) -> Array:
    """(node,) area of the outer surface [m2] that belongs to each of its nodes."""
    corners = result.outline[result.triangles]
    area = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1) / 2
    return np.asarray(np.bincount(result.triangles.ravel(), np.repeat(area / 3, 3), len(result.outline)), dtype=float)


def _paired(first: Result, second: Result, loads: tuple[int, int]) -> tuple[Index, Array, str]:
    """Pairs of modes, their MAC, and why they are paired by number where they are."""
    from scipy.spatial import KDTree

    distance, near = KDTree(second.outline).query(first.outline, k=NEIGHBOURS)
    size = float(np.linalg.norm(np.ptp(first.outline, axis=0)))
    apart = float(distance[:, 0].max())
    if apart > APART * size:
        count = min(first.frequencies.shape[1], second.frequencies.shape[1])
        why = f"the surfaces of the two runs are up to {1e3 * apart:.3g} mm apart, so modes are paired by their number"
        return np.repeat(np.arange(count)[:, None], 2, axis=1), np.full(count, np.nan), why
    shapes: list[Any] = [np.asarray(first.shapes[loads[0]], float), np.asarray(second.shapes[loads[1]], float)]
    weights = 1 / (distance + 1e-9 * size) ** 2
    weights /= weights.sum(axis=1, keepdims=True)
    same = first.outline.shape == second.outline.shape and np.allclose(first.outline, second.outline, atol=1e-9 * size)
    there = shapes[1] if same else np.einsum("nk,mnkd->mnd", weights, shapes[1][:, near])
    roots = np.sqrt(_areas(first))[:, None]  # a fine mesh counts no more than a coarse one
    flat = [(one * roots).reshape(len(one), -1) for one in (shapes[0], there)]
    table = mac(*flat)
    columns = partners(table, ALIKE)
    rows = np.flatnonzero(columns >= 0)
    return np.stack([rows, columns[rows]], axis=1), table[rows, columns[rows]], ""


MARKS = ("o", "s")
MAX_TICKS = 12


@drawing
def differences(found: RunDifference, names: tuple[str, str] = ("first run", "second run")) -> Any:
    """Return the figure of two runs: frequencies against those of the first, loss factors, pressure over the area.

    Intervals from 5 to 95 % are bars where a run has them.
    """
    fig = new_figure(WIDE, 2.7)
    axes = fig.subplots(1, 3)
    base = found.frequencies[0]
    places = np.arange(len(found.modes))
    for side, name in enumerate(names):
        shift = (side - 0.5) * 0.24
        look = {"color": colour(side), "ms": 4, "ls": "none", "label": name}
        run, load = (found.first, found.second)[side], found.loads[side]
        axes[0].plot(places + shift, 100 * (found.frequencies[side] / base - 1), MARKS[side], **look)
        if run.interval is not None:
            ends = 100 * (run.interval.ends[:, load, found.modes[:, side]] / base - 1)
            axes[0].vlines(places + shift, *ends, color=colour(side), lw=1.0)
        axes[1].plot(places + shift, found.loss_factors[side], MARKS[side], **look)
        pressure, share = carried(run, load)
        axes[2].plot(pressure / 1e6, 100 * share, color=colour(side), lw=1.4 - 0.3 * side, ls=("-", "--")[side])
    axes[0].axhline(0, color=SOFT, lw=0.7, zorder=0)
    axes[0].set(ylabel="change of frequency [%]")
    axes[1].set(ylabel="loss factor")
    if np.nanmin(np.concatenate(found.loss_factors), initial=np.inf) > 0:
        axes[1].set_yscale("log")
        plain_numbers(axes[1].yaxis)
    step = -(-len(places) // MAX_TICKS) or 1
    for ax in axes[:2]:
        ax.set(xlabel="mode of the first run", xticks=places[::step], xticklabels=found.modes[::step, 0] + 1)
        ax.set_xlim(-0.6, len(places) - 0.4)
    axes[2].set(xlabel="contact pressure [MPa]", ylabel="area at this pressure or more [%]", ylim=(0, 100))
    axes[2].set_xlim(left=0)
    for ax in axes:
        ax.grid(alpha=0.3)
    shared_legend(fig, axes[:1])
    return fig


def carried(result: Result, load: int) -> tuple[Array, Array]:
    """Pressures [Pa], rising from 0, and the share of the area of all joints that has at least each [-]."""
    order = np.argsort(result.pressure[load])
    pressure, area = result.pressure[load][order], result.weights[order]
    above = np.cumsum(area[::-1])[::-1] / area.sum()
    bears = pressure > 0
    rising, share = pressure[bears], above[bears]
    most, all_of_it = rising[-1:], share[:1]
    return np.concatenate([0 * most, rising, most]), np.concatenate([all_of_it, share, 0 * most])
