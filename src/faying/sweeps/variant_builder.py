"""What makes the laws, forces, gaps and scales of one point of a sweep or of an ensemble."""

from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from typing import Any, Generic, Protocol, TypeVar

import numpy as np

from faying.case.case import Case, materials_of
from faying.case.waves import JointPlacement
from faying.contact.auto import Choice
from faying.contact.build import check_entries
from faying.errors import InputError
from faying.form.form import Form
from faying.joint.joint_law import JointLaw
from faying.joint.preload_case import PreloadCase
from faying.joint.structure import Structure
from faying.materials import Material
from faying.reduction.part_shares import Scales
from faying.reduction.reduce import Gapped
from faying.reduction.reduced import ReducedModel
from faying.study.keys.law import LawChoice
from faying.study.keys.surface import Surface
from faying.study.keys.varied import MODEL, Varied, number_of, owners, varied
from faying.study.study import Study
from faying.typing import Array


def check_key(study: Study, key: str, *, models: bool, where: str) -> None:
    """InputError where the study has nothing that this key could vary; models: whether the law varies, too."""
    room, _, name = key.partition(".")
    if (number := varied(key)) is not None:
        known = owners((one.name for one in study.joints), (one.name for one in study.bolts), study.parts)
        number.check_owner(known, where)
    if room == "surface":
        if all(joint.surface is not None for joint in study.joints):
            raise InputError(f"{where}: every joint has a surface of its own; a sweep varies the study's [surface]")
        if not any(joint.surface is None and study.law_of(joint).needs_surface for joint in study.joints):
            raise InputError(f"{where}: no joint takes its law from [surface]; it would change nothing")
    if room == "law":
        if all(joint.law is not None for joint in study.joints):
            raise InputError(f"{where}: every joint has a law of its own; a sweep varies the study's [law]")
        if key == MODEL and not study.law.needs_surface:
            raise InputError(
                f'{where}: [law] gives "{study.law.model}" in full; other laws would lack their surface. '
                "Vary them on a study with [surface]"
            )
        if key not in (MODEL, "law.counterbody") and not models:
            check_entries(study.law.kind, [name])


@dataclass(frozen=True, kw_only=True)
class StudyVariant:
    """A study and its surfaces with some values put in.

    Args:
        study, surfaces: The study, and the surface of each joint.
        forces: Of the bolts [N] (b,), or at all loads (loads, b).
        scales: Factors on the stiffness and the mass of parts, by name [-].
    """

    study: Study
    surfaces: tuple[Surface, ...]
    forces: Array
    scales: Mapping[str, tuple[float, float]] = field(default_factory=dict)

    def with_values(self, values: Mapping[str, Any]) -> "StudyVariant":
        """The same with values by key, in SI units, put in: factors last, on what the other values are.

        A key that names one owner counts above one for all.
        """
        out, numbers = self, [number_of(key) for key in values if key != MODEL]
        if MODEL in values:
            out = replace(self, study=replace(self.study, law=replace(self.study.law, model=values[MODEL])))
        for number in sorted(numbers, key=lambda one: (one.name != one.varies, one.name)):
            named = {one.owner for one in numbers if one.owner and (one.room, one.name) == (number.room, number.name)}
            out = out._with(number, values[number.key], named)
        return out

    def _with(self, number: Varied, value: Any, named: Collection[str]) -> "StudyVariant":
        """The same with one more value: of all owners of the number but the named ones, or of the one it names."""
        study = self.study

        def put(owner: Any, name: str | None = None) -> Any:
            mine = name not in named if number.owner is None else number.owner == name
            return number.put(owner, value) if mine else owner

        if number.room == "law":
            return replace(self, study=replace(study, law=put(study.law)))
        if number.room == "joint":
            joints = tuple(put(joint, joint.name) for joint in study.joints)
            return replace(self, study=replace(study, joints=joints))
        if number.room == "surface":
            pairs = zip(study.joints, self.surfaces, strict=True)
            return replace(self, surfaces=tuple(s if joint.surface is not None else put(s) for joint, s in pairs))
        if number.room == "bolt":
            columns = [put(self.forces[..., k], bolt.name) for k, bolt in enumerate(study.bolts)]
            return replace(self, forces=np.stack(columns, axis=-1))
        scales = dict(self.scales)
        for part in scaled_parts(study, [number.key]):
            material = study.materials[study.parts[part]]
            new, (stiffness, mass) = number.put(material, value), scales.get(part, (1.0, 1.0))
            scales[part] = stiffness * (new.E / material.E), mass * (new.density / material.density)
        return replace(self, scales=scales)


def scaled_parts(study: Study, keys: Iterable[str]) -> tuple[str, ...]:
    """Parts whose stiffness or mass some keys vary, each of which names a part, or the material of parts."""
    owners = [(number.room, number.owner) for number in map(varied, keys) if number is not None]
    of = {part: (("part", part), ("material", material)) for part, material in study.parts.items()}
    return tuple(dict.fromkeys(part for owner in owners for part, names in of.items() if owner in names))


LATELY = 32  # laws and tables that are not made again
Known = TypeVar("Known")
Made = TypeVar("Made")


def contact_shares(weights: Array, laws: Sequence[JointLaw], pressures: Sequence[Array]) -> tuple[float, float]:
    """Shares [-] of the joints' area that are open, and of what touches that is pressed beyond the end of its law.

    weights (q,): area of all points [m2]; pressures [Pa]: of each joint.
    """
    p = np.concatenate(pressures)
    ends = np.repeat([law.model.greatest_pressure for law in laws], [len(one) for one in pressures])
    touching = float(weights @ (p > 0))
    return 1 - touching / float(weights.sum()), float(weights @ (p > ends)) / touching if touching else 0.0


class Design(Protocol):
    """Points at which a study is evaluated, by their index."""

    @property
    def study(self) -> Study:
        """The study that they vary."""

    @property
    def surfaces(self) -> tuple[Surface, ...]:
        """The surface of each joint."""

    @property
    def size(self) -> int:
        """Number of points."""

    @property
    def middle(self) -> int:
        """A point in the middle of all."""

    @property
    def keys(self) -> tuple[str, ...]:
        """What varies."""

    def corners(self, most: int) -> list[int]:
        """At most so many of the points that lie farthest out."""

    def point(self, index: int) -> StudyVariant:
        """The study at one point."""


class Lately(Generic[Known, Made]):
    """What was made lately, each with all that it was made from, which is compared by equality."""

    def __init__(self) -> None:
        self._made: list[tuple[Known, Made]] = []

    def get(self, known: Known, make: Callable[[], Made]) -> Made:
        """What was made from an equal object; made now where there is none."""
        for other, made in reversed(self._made):
            if other == known:
                return made
        self._made = [*self._made[1 - LATELY :], (known, make())]
        return self._made[-1][1]


@dataclass(frozen=True, eq=False)
class MadeLaw:
    """A contact law that was made once, and equals no other one."""

    chosen: Choice


@dataclass(frozen=True, kw_only=True)
class VariantBuilder:
    """All that makes the laws and forces of a point: the design, and the materials that meet at each joint."""

    design: Design
    pairs: tuple[tuple[Material, Material], ...]
    places: tuple[JointPlacement, ...] = ()  # of each joint, where its form varies; empty where none does
    # contact laws, and the laws of joints with their tables: along an axis of preload they stay the same
    _made: Lately[tuple[int, LawChoice, Surface], MadeLaw] = field(default_factory=Lately, repr=False, compare=False)
    _laid: Lately[tuple[MadeLaw, JointLaw], JointLaw] = field(default_factory=Lately, repr=False, compare=False)
    _formed: Lately[tuple[int, Form | None], Array] = field(default_factory=Lately, repr=False, compare=False)

    def __getstate__(self) -> dict[str, Any]:
        return {**vars(self), "_made": Lately(), "_laid": Lately(), "_formed": Lately()}

    @property
    def parts(self) -> tuple[str, ...]:
        """Parts whose stiffness or mass varies."""
        return scaled_parts(self.design.study, self.design.keys)

    def gaps(self, index: int) -> list[Array] | None:
        """Gap [m] (q,) of each joint at one point; None where no form varies."""
        if not self.places:
            return None
        forms = enumerate(joint.form for joint in self.design.point(index).study.joints)
        return [self._formed.get(one, partial(self.places[one[0]].gap, one[1])) for one in forms]

    @property
    def modelled_gaps(self) -> list[Array] | None:
        """Gap [m] (q,) of each joint under the form of the study; None where no form varies."""
        places = zip(self.places, self.design.study.joints, strict=True) if self.places else ()
        return [place.gap(joint.form) for place, joint in places] or None

    def laws(self, index: int) -> tuple[list[JointLaw], Array, list[float | None]]:
        """Law of each joint, force of each bolt [N] and friction of each joint at one point."""
        return self.of(self.design.point(index))

    def of(self, point: StudyVariant) -> tuple[list[JointLaw], Array, list[float | None]]:
        """The same of a study with some values put in."""
        laws = [self._law(point, number) for number in range(len(point.surfaces))]
        return laws, point.forces, [joint.friction for joint in point.study.joints]

    def _law(self, point: StudyVariant, number: int) -> JointLaw:
        joint, surface, (rough, other) = point.study.joints[number], point.surfaces[number], self.pairs[number]
        law = point.study.law_of(joint)
        made = self._made.get((number, law, surface), lambda: MadeLaw(law.make(surface, rough, other)))
        return joint.laid(made.chosen, rough.nu, lambda law: self._laid.get((made, law), lambda: law))

    def variant(self, index: int, gaps: Sequence[Array], start: Array | None = None) -> Gapped:
        """One point, as bases are trained on it; gaps: those where no form varies; start: as `Gapped` has it."""
        laws, forces, friction = self.laws(index)
        gaps, scales = self.gaps(index) or gaps, self.scales(index)
        return Gapped(laws=laws, forces=forces, friction=friction, gaps=gaps, scales=scales, start=start)

    def model_at(self, model: ReducedModel, index: int) -> ReducedModel:
        """A model of the structure with the gaps and the scales of one point."""
        return model.with_gaps(self.gaps(index)).with_scales(self.scales(index))

    def scales(self, index: int) -> Scales | None:
        """Factors on the stiffness and the mass of each part that varies; None where none does."""
        if not self.parts:
            return None
        found = self.design.point(index).scales
        return [found.get(part, (1.0, 1.0)) for part in self.parts]

    def case(self, structure: Structure, index: int) -> Case:
        """One point, ready to be solved in full at its one load.

        structure: that of the design, of whose parts E and density are scaled where they vary.
        """
        point = self.design.point(index)
        laws, forces, friction = self.laws(index)
        materials = structure.materials
        if point.scales:
            materials = materials_of(point.study, structure.mesh)
            for part, (stiffness, mass) in point.scales.items():
                solid = materials[part]
                materials[part] = replace(solid, E=solid.E * stiffness, density=(solid.density or 0.0) * mass)
        study = replace(point.study, preloads=(PreloadCase(tuple(forces.tolist())),))
        structure = structure.with_joints(laws=laws, friction=friction, gaps=self.gaps(index))
        structure = replace(structure, materials=materials)
        return Case(study=study, structure=structure, surfaces=point.surfaces)
