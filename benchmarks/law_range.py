"""How far measured stiffness lies from each law: the range of the law in every interval (`faying.case.law_range`).

    python benchmarks/law_range.py [--write]

Takes ln(measured k_n / k_n of the law) of the specimens of docs/theory/measured-stiffness.csv, like beside like: k_load
where an approach was measured, k_n of unloading else. A specimen is one pair of faces, and counts once: the mean over
its pressures. The model is

    ln ratio = median of the class + source + specimen,

with two classes (both faces of steel or harder, or one of a soft metal) and two variances, by restricted maximum
likelihood. The range is that of one more specimen of one more source: 5 to 95 % of Student's t with the degrees of
freedom of Satterthwaite, (sources - classes) for what sources share and (specimens - sources) for the rest. Prints the
medians and factors of all laws, and how many values lie inside when each source in turn is left out. With --write it
solves the laws again and writes docs/theory/measured-over-laws.csv, which takes a quarter of an hour.
"""

import csv
import re
import sys
from collections import defaultdict
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from scipy.optimize import minimize
from scipy.stats import t as student

FILE = Path(__file__).parents[1] / "docs" / "theory" / "measured-over-laws.csv"
LAWS = "half-space", "CMY", "Mikic", "GW", "GW-CEB", "GW-KE", "GW-ZMC", "GW-JG", "Persson", "JK", "ME"
KEYS = ("source", "specimen", "class", "p [MPa]", "measured [MPa/um]")


@dataclass(frozen=True, kw_only=True)
class Specimen:
    """One pair of faces: its source, whether a face is of a soft metal, and ln(measured / law) at its pressures."""

    source: str
    name: str
    soft: bool
    values: tuple[float, ...]


@dataclass(frozen=True, kw_only=True)
class Fit:
    """Medians of ln ratio of the classes (hard, soft as far as there are any), their errors, and two deviations.

    Args:
        classes: False for hard, True for soft metals.
        medians, errors: of ln ratio, one for each class [-].
        sources, specimens: standard deviation between sources, and between specimens of one [-].
        counts: numbers of sources and of specimens.
    """

    classes: tuple[bool, ...]
    medians: np.ndarray
    errors: np.ndarray
    sources: float
    specimens: float
    counts: tuple[int, int]

    @property
    def half(self) -> np.ndarray:
        """Half of 5 to 95 % of ln ratio of one more specimen of one more source (classes,)."""
        shared, own = self.sources**2 + self.errors**2, self.specimens**2
        sources, specimens = self.counts
        free = max(sources - len(self.classes), 1), max(specimens - sources, 1)
        freedom = (shared + own) ** 2 / (shared**2 / free[0] + own**2 / free[1])
        return np.asarray(student.ppf(0.95, freedom) * np.sqrt(shared + own))

    def inside(self, one: Specimen) -> list[bool]:
        """Whether each value of a specimen lies within 5 to 95 %."""
        k = self.classes.index(one.soft)
        return [bool(abs(value - self.medians[k]) <= self.half[k]) for value in one.values]


def fitted(specimens: list[Specimen]) -> Fit:
    """The fit by restricted maximum likelihood."""
    y = np.array([np.mean(one.values) for one in specimens])
    classes = tuple(sorted({one.soft for one in specimens}))
    design = np.array([[float(one.soft == which) for which in classes] for one in specimens])
    same = np.array([[float(one.source == other.source) for other in specimens] for one in specimens])

    def solved(deviations: np.ndarray) -> tuple[float, np.ndarray, np.ndarray]:
        cov = deviations[0] ** 2 * same + deviations[1] ** 2 * np.eye(len(y))
        weight = np.linalg.inv(cov)
        inner = design.T @ weight @ design
        medians = np.linalg.solve(inner, design.T @ weight @ y)
        left = y - design @ medians
        cost = np.linalg.slogdet(cov)[1] + np.linalg.slogdet(inner)[1] + left @ weight @ left
        return float(cost), medians, np.sqrt(np.diag(np.linalg.inv(inner)))

    starts = [np.log([a, b]) for a in (0.05, 0.6) for b in (0.3, 1.0)]
    close = {"xatol": 1e-6, "fatol": 1e-10}
    found = [minimize(lambda x: solved(np.exp(x))[0], x, method="Nelder-Mead", options=close) for x in starts]
    deviations = np.exp(min(found, key=lambda one: one.fun).x)
    _, medians, errors = solved(deviations)
    return Fit(
        classes=classes,
        medians=medians,
        errors=errors,
        sources=float(deviations[0]),
        specimens=float(deviations[1]),
        counts=(len({one.source for one in specimens}), len(specimens)),
    )


def specimens(law: str) -> list[Specimen]:
    """All specimens with ln(measured / law) at the pressures at which the law has an answer."""
    found: dict[tuple[str, str, bool], list[float]] = defaultdict(list)
    with FILE.open(newline="") as file:
        for row in csv.DictReader(file):
            if row[law]:
                key = row["source"], row["specimen"], row["class"] == "soft"
                found[key].append(float(np.log(float(row["measured [MPa/um]"]) / float(row[law]))))
    return [Specimen(source=a, name=b, soft=c, values=tuple(values)) for (a, b, c), values in found.items()]


def left_out(every: list[Specimen]) -> dict[str, tuple[int, int]]:
    """Values inside and values in all, of each source in the range that the other sources give."""
    out = {}
    for source in sorted({one.source for one in every}):
        fit = fitted([one for one in every if one.source != source])
        inside = [good for one in every if one.source == source for good in fit.inside(one)]
        out[source] = (sum(inside), len(inside))
    return out


def write() -> None:
    """Solve every law on every measurement, and write the table."""
    from measured_conductance import measured, predicted, table

    from faying.case.law_range import is_soft

    with FILE.open("w", newline="") as file:
        out = csv.writer(file, lineterminator="\n")
        out.writerow((*KEYS, *LAWS))
        for row, one in zip(table("measured-stiffness.csv"), measured(), strict=True):
            if one.kind == "range":
                continue
            named = re.match(r"specimen \d|arithmetic mean roughness [\d.]+ um", row["note"])
            names = dict.fromkeys((one.pair.first.name, one.pair.second.name))
            words = [" on ".join(names), one.finish, f"{row['roughness [um]']} um", named.group() if named else ""]
            k = [predicted(law, one) * 1e-12 for law in LAWS]
            cells = ["" if np.isnan(value) else f"{value:.4g}" for value in k]
            kind = "soft" if is_soft(one.pair.first, one.pair.second) else "hard"
            name = ", ".join(filter(None, words))
            out.writerow((one.source, name, kind, f"{one.pressure * 1e-6:.4g}", f"{one.k_n * 1e-12:.5g}", *cells))
            file.flush()


def main() -> None:
    """Print the ranges, the deviations, and the values inside when a source is left out."""
    if "--write" in sys.argv[1:]:
        write()
    print("| law | steel, median | soft metals, median | 5 to 95 %, factor | sources, specimens | inside, left out |")
    print("|---|---|---|---|---|---|")
    for law in LAWS:
        every = specimens(law)
        fit = fitted(every)
        hard, soft = np.exp(fit.medians)
        shares = left_out(every)
        inside, number = (sum(column) for column in zip(*shares.values(), strict=True))
        print(
            f"| {law} | {hard:.2g} | {soft:.2g} | {np.exp(fit.half.max()):.2g} | {fit.sources:.2f}, "
            f"{fit.specimens:.2f} | {inside} of {number} | " + ", ".join(f"{k}/{n}" for k, n in shares.values())
        )


if __name__ == "__main__":
    main()
