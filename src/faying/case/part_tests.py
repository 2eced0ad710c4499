"""What weighing and ringing each part alone says of its stiffness and mass, and of the modes of the assembly.

Of a free part of stiffness s_E K and mass s_m M, mode i has

    ln f_i = ln f_i0 + (ln s_E - ln s_m) / 2 + e_i,

f_i0 the model's frequency, e_i what dimensions, sensors and the test do to this mode alone. The factors have normal
priors, so that their mean and covariance are in closed form. A mode of the assembly takes up the share kappa_p of its
strain energy and mu_p of its kinetic energy in part p, and moves by

    d ln f = sum over p of (kappa_p ln s_E,p - mu_p ln s_m,p) / 2.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from faying.case.scatter import DENSITY_SD, LEVELS, ONE_EACH_WAY, SCORE, mode_sd, of_parts, stated, structure_sd
from faying.fe.surplus import Surplus
from faying.joint.assembled_parts import unknowns_of
from faying.joint.modal import ModalProblem, ModesChoice
from faying.joint.shared_modes import modes_with
from faying.joint.structure import Structure
from faying.notes import Note
from faying.numerics.follow import partners
from faying.study.keys.material import PartTestChoice
from faying.study.keys.varied import number_of
from faying.study.study import Study
from faying.typing import Array, Index

BALANCE_SD = 1e-3  # of ln of a weighed mass: a balance of 0.1 %, and what hangs on the part
PART_SD = 0.01  # of ln f of each mode of one free part before its test: a bronze disc has 1.3 %
LEAST_SD = 3e-3  # of ln f of each mode: sensors and cables, and how far a part is from its drawing
FARTHEST = 4.0  # standard deviations beyond which a measured frequency is that of another mode
MODES_EACH, SPARE_MODES = 2, 10  # of the model for each measured one, and in all: a test misses what it does not excite
TINY = 1e-9  # likeness above none
AS_MODELLED = np.zeros(2)  # ln of both factors
SHIFTS = np.linspace(-3, 3, 61)  # common factors that are tried, in standard deviations of their prior


@dataclass(frozen=True, kw_only=True)
class PartFactors:
    """Factors on stiffness and mass of one part, as its own test leaves them.

    Args:
        mean: ln s_E and ln s_m (2,).
        covariance: of both (2, 2).
        scatter: standard deviation of ln f of each mode by itself [-].
        count: how many modes of the test they come from.
    """

    mean: Array
    covariance: Array
    scatter: float
    count: int

    @classmethod
    def of(
        cls,
        ratios: Array,
        errors: Array,
        *,
        prior: tuple[float, float],
        mode: float,
        mass: float | None = None,
        mean: Array = AS_MODELLED,
    ) -> "PartFactors":
        """Both factors in closed form; the scatter of the modes counts as one of the size of the prior, and they do.

        Args:
            ratios: ln of measured over computed frequency (t,).
            errors: Standard deviation of ln f_i0 by the mesh (t,).
            prior, mean: Standard deviations of ln s_E and ln s_m before the test, and their means (2,).
            mode: Standard deviation of ln f of a mode by itself, before the test.
            mass: ln of the weighed over the computed mass; None where it was not weighed.

        Source:
            Normal prior and likelihood: A. Gelman et al., Bayesian Data Analysis, 3rd ed., sections 2.6 and 14.8.
        """
        rest = ratios - ratios.mean() if len(ratios) else ratios
        before = np.diag(np.array(prior) ** -2.0)
        scatter = max(LEAST_SD, float(np.sqrt((mode**2 + rest @ rest) / max(len(ratios), 1))))
        rows = np.tile([0.5, -0.5], (len(ratios), 1))
        seen, precision = ratios, 1 / (scatter**2 + errors**2)
        if mass is not None:
            rows, seen = np.vstack([rows, [0.0, 1.0]]), np.append(ratios, mass)
            precision = np.append(precision, BALANCE_SD**-2)
        covariance = np.linalg.inv(before + (rows.T * precision) @ rows)
        mean = covariance @ (before @ mean + rows.T @ (precision * seen))
        return cls(mean=mean, covariance=covariance, scatter=scatter, count=len(ratios))


@dataclass(frozen=True, kw_only=True)
class PartAlone:
    """One part by itself, with the mesh and the material that it has in a structure, and its test."""

    name: str
    structure: Structure
    test: PartTestChoice

    @property
    def measured(self) -> Array:
        """Frequencies [Hz] (t,) of its own test, rising."""
        return np.sort(np.array(self.test.frequencies))

    def modes(self, count: int) -> tuple[Array, Array]:
        """Its lowest free elastic modes (m,): frequencies [Hz] and their estimated errors by the mesh [-]."""
        structure = self.structure
        problem = ModalProblem(structure=structure, choice=ModesChoice(count=count))
        found = modes_with(problem, *structure.dynamic_matrices, rigid=structure.rigid)
        elastic = slice(structure.rigid_count, structure.rigid_count + count)
        squares = (2 * np.pi * found.frequencies[elastic]) ** 2
        surplus = Surplus.of(structure.mesh, structure.materials, np.zeros(len(structure.mesh.points), dtype=bool))
        errors = np.zeros(count) if surplus is None else surplus.error(found.shapes[:, elastic], squares) / 2
        return found.frequencies[elastic], errors

    def factors(self, mean: Array, prior: tuple[float, float], mode: float) -> PartFactors:
        """What the test says.

        mean, prior: of ln s_E and ln s_m before, and standard deviations; mode: that of ln f of each mode by itself.
        """
        measured = self.measured
        weighed = None if self.test.mass is None else float(np.log(self.test.mass / self.structure.mass))
        ratios = errors = np.zeros(0)
        if len(measured):
            count = min(MODES_EACH * len(measured) + SPARE_MODES, self.structure.mesh.unknowns // 4)
            computed, errors = self.modes(count)
            ratios = np.log(measured[:, None] / computed) + errors  # a finer mesh has it lower by its error
            common = (mean[0] - (mean[1] if weighed is None else weighed)) / 2
            pairs = same_modes(ratios - common, prior[0] / 2, mode)
            ratios, errors = ratios[pairs], errors[pairs[1]]
        return PartFactors.of(ratios, errors / SCORE, prior=prior, mode=mode, mass=weighed, mean=mean)


def same_modes(ratios: Array, structure: float, mode: float) -> tuple[Index, Index]:
    """Indices (t,) of the measured modes that the model has, and of its modes (t,).

    Of all common factors the one is taken under which the modes, each paired once, and the factor are most likely.

    Args:
        ratios: ln of measured over computed frequency (test, model).
        structure, mode: standard deviations of the common factor and of each mode by itself.
    """
    best, found = np.inf, (np.zeros(0, dtype=np.int64),) * 2
    for shift in SHIFTS * structure:
        costs = np.minimum(((ratios - shift) / mode) ** 2, FARTHEST**2)  # what is farther belongs to another mode
        columns = partners(FARTHEST**2 - costs, TINY)
        rows = np.flatnonzero(columns >= 0)
        columns = columns[rows]
        total = (costs[rows, columns] - FARTHEST**2).sum() + (shift / structure) ** 2
        if total < best:
            best, found = total, (rows, columns)
    return found


@dataclass(frozen=True, kw_only=True)
class KnownParts:
    """Parts of a structure that were weighed or rung alone, or of which [uncertain] lists something.

    Args:
        study: Which has their tests.
        parts, factors: those with a test (p), and what their tests say.
        moved, spread: what those without move ln f by as they are listed, and its standard deviation (loads, m) [-].
        by_factor: d ln f by ln s_E and ln s_m of each part with a test (p, loads, m, 2) [-].
        others: share of the strain energy in parts without a test (loads, m) [-]; 1 where none has one.
        all_rung: whether every part has measured modes.
    """

    study: Study
    parts: tuple[PartAlone, ...]
    factors: tuple[PartFactors, ...]
    moved: Array
    spread: Array
    by_factor: Array
    others: Array
    all_rung: bool

    @classmethod
    def of(cls, study: Study, structure: Structure, modes: Sequence[tuple[Array, Array]]) -> "KnownParts | None":
        """Those of a study; None where no part has a test, and [uncertain] lists nothing of parts.

        modes: elastic modes under each load, their frequencies [Hz] (m,) and mass-normalised shapes (n, m).
        """
        tests = study.part_tests
        listed = {number_of(key).owner for key in stated(study.uncertain) if of_parts(key)}
        more = (name for name in structure.mesh.parts if listed & {name, study.parts[name]})
        names = list(dict.fromkeys([*tests, *more]))
        if not names:
            return None
        means, roots = _listed(study, names)
        parts = [
            PartAlone(name=name, structure=structure.alone(name), test=tests.get(name, PartTestChoice()).read())
            for name in names
        ]
        energies = [energy_shares(structure, parts, *of_load) for of_load in modes]
        strain, kinetic, others = (np.stack(one) for one in zip(*energies, strict=True))
        by_factor = np.stack([strain, -kinetic], axis=-1).swapaxes(0, 1) / 2
        own, factors = min(mode_sd(study.uncertain), PART_SD), list[PartFactors]()
        for part, mean, sd in zip(parts[: len(tests)], means, np.linalg.norm(roots, axis=2), strict=False):
            prior = float(np.hypot(2 * structure_sd(study.uncertain), sd[0])), float(sd[1]) or DENSITY_SD
            factors.append(part.factors(mean, prior, own))
        rest = slice(len(tests), len(parts))
        return cls(
            study=study,
            parts=tuple(parts[: len(tests)]),
            factors=tuple(factors),
            moved=np.einsum("plmi,pi->lm", by_factor[rest], means[rest]),
            spread=np.linalg.norm(np.einsum("plmi,pik->lmk", by_factor[rest], roots[rest]), axis=-1),
            by_factor=by_factor[: len(tests)],
            others=others + strain[:, rest].sum(axis=1) if tests else np.ones_like(others),
            all_rung=sum(len(part.measured) > 0 for part in parts) == len(structure.mesh.parts),
        )

    def instead(self, offsets: Mapping[str, Array]) -> tuple[dict[str, Array], Array]:
        """Offsets of ln f (2, loads, m) by what is not known, "structure" and "mode" as the parts' tests leave them.

        And what the tests move ln f by (loads, m). Parts without a test keep their share of the prior. Where all were
        rung, "parts" stands for "structure".
        """
        structure, mode = offsets["structure"], offsets["mode"]
        strain, pairs = 2 * self.by_factor[..., 0], list(zip(self.by_factor, self.factors, strict=True))
        middle = self.moved + sum(by @ one.mean for by, one in pairs)
        variance = self.spread**2 + sum(np.einsum("lmi,ij,lmj->lm", by, one.covariance, by) for by, one in pairs)
        own = sum((share * one.scatter) ** 2 for share, one in zip(strain, self.factors, strict=True))
        rest = np.clip(1 - strain.sum(axis=0), 0.0, 1.0)
        found = {name: one for name, one in offsets.items() if name != "structure"}
        found["parts" if self.all_rung else "structure"] = _added(structure * self.others, variance)
        found["mode"] = _added(mode * rest, own)
        return found, np.asarray(middle)

    def left(self) -> tuple[Array, Array]:
        """What the tests move ln f by (loads, m), and the standard deviation that is left of it, all modes' and own."""
        ends = SCORE * ONE_EACH_WAY * np.ones(self.others.shape)
        choice = self.study.uncertain
        found, middle = self.instead({"structure": structure_sd(choice) * ends, "mode": mode_sd(choice) * ends})
        return middle, np.hypot(*(high for _, high in found.values())) / SCORE

    def notes(self) -> Iterator[Note]:
        """What the test of each part says, and which of its modes the model does not have."""
        for part, one in zip(self.parts, self.factors, strict=True):
            name, (stiffness, mass), sd = part.name, np.exp(one.mean), np.sqrt(np.diag(one.covariance))
            modes = f"; each of {one.count} modes is within {100 * one.scatter:.2g} %" if one.count else ""
            text = (
                f"part {name!r}, by its own test: stiffness {stiffness:.4f} +- {sd[0]:.4f} and mass {mass:.4f} +- "
                f"{sd[1]:.4f} times that of the model{modes} (standard deviations)"
            )
            yield Note(code="part-test", text=text)
            look = "look at its geometry, material and units"
            if abs(one.mean[1]) > FARTHEST * DENSITY_SD:
                yield Note(
                    code="part-mass", severity="limit", text=f"part {name!r} weighs {mass:.3g} times its model; {look}"
                )
            if one.count < (measured := len(part.measured)):
                text = (
                    f"part {name!r}: the model has {one.count} of its {measured} measured modes; the others are left "
                    f"out. Give free modes of the part alone; else {look}"
                )
                yield Note(code="test-modes", severity="limit", text=text)


def _added(prior: Array, variance: Any) -> Array:
    """Both ends (2, loads, m) of a normal prior with another normal number added, which has no mean."""
    half = np.hypot(prior[1], SCORE * np.sqrt(variance))
    return np.stack([-half, half])


def _listed(study: Study, names: Sequence[str]) -> tuple[Array, Array]:
    """What [uncertain] lists of parts: means of ln s_E and ln s_m (p, 2), and a root of their covariance (p, 2, keys).

    Parts of one material have its E and its density in common.
    """
    found = {key: one for key, one in stated(study.uncertain).items() if of_parts(key)}
    means, roots = np.zeros((len(names), 2)), np.zeros((len(names), 2, len(found)))
    for column, (key, one) in enumerate(found.items()):
        number = number_of(key)
        low, middle, high = one.quantile(LEVELS)
        for k, name in enumerate(names):
            if number.owner == (name if number.room == "part" else study.parts[name]):
                material, which = study.materials[study.parts[name]], int(number.name in ("density", "mass"))
                put = number.put(material, middle)
                means[k, which] += np.log((put.density / material.density) if which else put.E / material.E)
                roots[k, which, column] = np.log(high / low) / (2 * SCORE)
    return means, roots


def energy_shares(
    structure: Structure, parts: Sequence[PartAlone], frequencies: Array, shapes: Array
) -> tuple[Array, Array, Array]:
    """Shares [-] of some parts in the strain and the kinetic energy of modes (p, m); of other parts in strain (m,).

    frequencies, shapes: of elastic modes, [Hz] (m,) and mass-normalised (n, m).
    """
    squares, strain, kinetic = (2 * np.pi * frequencies) ** 2, [], []
    for part in parts:
        own, (K, M) = shapes[unknowns_of(structure.mesh.part_nodes(part.name))], part.structure.matrices
        strain.append(np.einsum("im,im->m", own, K @ own) / squares)
        kinetic.append(np.einsum("im,im->m", own, M @ own))
    every = np.einsum("im,im->m", shapes, structure.matrices[0] @ shapes) / squares
    return np.stack(strain), np.stack(kinetic), np.clip(every - np.sum(strain, axis=0), 0.0, 1.0)
