"""Bases for all points of a sweep or an ensemble: where they are trained, and where they are looked at afterwards."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from typing import Self

import numpy as np

from faying.case.case import checked_mesh, materials_at, structure_of
from faying.case.waves import JointPlacement
from faying.errors import FayingError
from faying.joint.structure import Structure
from faying.progress import Report
from faying.reduction.part_shares import PartShares
from faying.reduction.reduce import STATIC_SHARE, Reduction
from faying.reduction.reduced import ReducedModel
from faying.study.keys.varied import varied
from faying.study.study import Study
from faying.sweeps.variant_builder import Design, VariantBuilder
from faying.typing import Array

CORNERS, RANDOM, CHECKS = 16, 8, 5  # variants trained on, and those that are looked at afterwards
SPARE_MODES = 3  # trained beyond those wanted: a mode that comes down between the corners is in the basis then
# the estimate is that of a basis a hundred times coarser; beyond this multiple of the tolerance a point is trained on
REFINED_ABOVE = 60.0
SLACK = 5.0  # times the tolerance: to which bases are trained where samples need them to grow
SEED = 20241121


class Trainer:
    """Makes the bases when they are first needed, and enriches them at points of the design."""

    def __init__(
        self, study: Study, structure: Structure, builder: VariantBuilder, tolerance: float, report: Report
    ) -> None:
        self.study, self.structure, self.builder, self.tolerance = study, structure, builder, tolerance
        self.report = report
        self.reduction: Reduction | None = None

    @classmethod
    def of(
        cls, study: Study, design: Design, tolerance: float, report: Report, structure: Structure | None = None
    ) -> Self:
        """Take the structure of a study, or make it; what varies is that of the design."""
        structure = structure or structure_of(study, checked_mesh(study), design.surfaces)
        pairs = tuple(materials_at(study, structure.mesh, joint) for joint in study.joints)
        places = tuple[JointPlacement, ...]()
        if any(number.of_form for number in map(varied, design.keys) if number is not None):
            joints = zip(study.joints, structure.joints, design.surfaces, strict=True)
            places = tuple(JointPlacement.of(structure.mesh, one, j.interface, surface) for one, j, surface in joints)
        builder = VariantBuilder(design=design, pairs=pairs, places=places)
        return cls(study, structure, builder, tolerance, report)

    def model(self, more: Sequence[int] = (), learn: Sequence[int] = ()) -> ReducedModel:
        """Return the bases as `trained` leaves them, for the modes that are wanted."""
        return replace(self.trained(more, learn).model, count=self.study.modes.count)

    def trained(self, more: Sequence[int] = (), learn: Sequence[int] = ()) -> Reduction:
        """Return the bases, trained on the corners and some points between, and on the points of `more`.

        learn: points, those of one sample one behind the other, to what these need the bases are compressed.
        """
        design = self.builder.design
        generator = np.random.default_rng(SEED)
        if self.reduction is None:
            points = design.corners(CORNERS)
            points += generator.choice(design.size, min(RANDOM, design.size), replace=False).tolist()
            self.reduction = self._first_bases([design.middle, *points])
            self._train(self.reduction, [*points, *more], "training")
            self.reduction.compress(self.tolerance)
            # a form changes which points touch: more of its grid is looked at
            count = (3 if self.builder.places else 1) * CHECKS
            checks = generator.choice(design.size, min(count, design.size), replace=False).tolist()
            self._check(self.reduction, checks)
            if not learn:
                return self.reduction
        else:
            # samples are many and miss by what their estimate allows; points of a sweep are answers
            self._train(self.reduction, more, "training", SLACK if learn else 1.0)
        self._learn(self.reduction, learn)
        self.reduction.compress(self.tolerance)  # so that the estimate knows what was learnt
        return self.reduction

    def modelled(self, points: Sequence[int]) -> Reduction:
        """Return bases for some points with the form of the study in place of their own, and for nothing else."""
        if self.reduction is None:
            self.reduction = self._first_bases(points[-1:], modelled=True)
            self._train(self.reduction, points, "training", modelled=True)
        return self.reduction

    def resume(self, kept: Mapping[str, Array]) -> None:
        """Go on with bases that interrupted work has left, from `Reduction.arrays`."""
        self.report("reference solution", 0, 0)
        shares = self._part_shares()
        self.reduction = Reduction.resumed(self.structure, kept, solver=self.study.modes.solver, shares=shares)

    def _part_shares(self) -> PartShares | None:
        parts = self.builder.parts
        return PartShares.of(self.structure, parts) if parts else None

    def _first_bases(self, points: Sequence[int], *, modelled: bool = False) -> Reduction:
        """Bases from the first of the points that has an answer; raises what the first of them met where none has.

        modelled: with the form of the study.
        """
        fault: FayingError | None = None
        for index in dict.fromkeys(points):
            self.report("reference solution", 0, 0)
            try:
                laws, forces, _ = self.builder.laws(index)
                return Reduction.of(
                    self.structure.with_joints(gaps=None if modelled else self.builder.gaps(index)),
                    laws,
                    forces,
                    count=self.study.modes.count + SPARE_MODES,
                    shift_frequency=self.study.modes.shift_frequency,
                    solver=self.study.modes.solver,
                    shares=self._part_shares(),
                )
            except FayingError as met:
                fault = fault or met
        assert fault is not None
        raise fault

    def _train(
        self, reduction: Reduction, points: Iterable[int], what: str, slack: float = 1.0, *, modelled: bool = False
    ) -> None:
        fault: FayingError | None = None
        start: Array | None = None
        for number, index in enumerate(points):
            self.report(f"{what} {number + 1}", 0, 0)
            try:
                start = reduction.train(
                    *self.builder.laws(index),
                    tolerance=slack * self.tolerance,
                    start=start,
                    gaps=self.builder.modelled_gaps if modelled else self.builder.gaps(index),
                    scales=self.builder.scales(index),
                )
            except FayingError as met:  # a point without an answer is reported when it is evaluated
                fault, start = met, None
        if fault is not None and not reduction.trained:
            raise fault

    def _learn(self, reduction: Reduction, points: Iterable[int]) -> None:
        """Tell the bases what points need of them."""
        model, start = reduction.model, None
        for index in points:
            self.report("compression", 0, 0)
            try:
                laws, forces, friction = self.builder.laws(index)
                found = self.builder.model_at(model, index).evaluate(laws, forces, friction, start)
            except FayingError:
                start = None
                continue
            reduction.learn(laws, found)
            start = found.preload.displacement

    def error(self, index: int, reduction: Reduction) -> float:
        """Relative error of the frequencies [-] at one point, by `Reduction.frequency_error`; NaN: no answer."""
        try:
            laws, forces, friction = self.builder.laws(index)
            reduction.model = self.builder.model_at(reduction.model, index)
            found = reduction.model.equilibrium(laws, forces, friction)
            return reduction.frequency_error(laws, forces, friction, found, self.study.modes.count)
        except FayingError:
            return float("nan")

    def _check(self, reduction: Reduction, points: Sequence[int]) -> None:
        """Look at points that were not trained on by their full residual; train on those that are not good enough."""
        poor = []
        for index in points:
            self.report("check", 0, 0)
            try:
                laws, forces, friction = self.builder.laws(index)
                reduction.model = self.builder.model_at(reduction.model, index)
                found = reduction.model.equilibrium(laws, forces, friction)
                error = reduction.modal_error(laws, found.pressures)
                balance, _ = reduction.static_error(laws, forces, friction, found)
            except FayingError:
                continue
            if error.max() > 4 * self.tolerance or balance > 4 * STATIC_SHARE * self.tolerance:
                poor.append(index)
        self._train(reduction, poor, "training")
