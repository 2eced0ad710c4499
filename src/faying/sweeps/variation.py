"""A study with other values put in where its numbers may vary."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from faying.contact.build import check_entries
from faying.errors import InputError
from faying.form.form import Form
from faying.study.keys.joint import JointChoice
from faying.study.keys.surface import Surface
from faying.study.keys.varied import MODEL, formed
from faying.study.study import Study
from faying.typing import Array


def check_key(study: Study, key: str, *, models: bool, where: str) -> None:
    """InputError where the study has nothing that this key could vary; models: whether the law varies, too."""
    parts = key.split(".")
    known = {
        "bolt": [bolt.name for bolt in study.bolts],
        "joint": [joint.name for joint in study.joints],
        "part": list(study.parts),
    }
    for room, names in known.items():
        one = parts[0] == room and (len(parts) == 4 or (len(parts) == 3 and not formed(parts)))
        if one and parts[1] not in names:
            raise InputError(f"{where}: no {room} is called {parts[1]!r}; the {room}s are {', '.join(names)}")
    if parts[0] == "surface":
        if all(joint.surface is not None for joint in study.joints):
            raise InputError(f"{where}: every joint has a surface of its own; a sweep varies the study's [surface]")
        if not any(joint.surface is None and study.law_of(joint).needs_surface for joint in study.joints):
            raise InputError(f"{where}: no joint takes its law from [surface]; it would change nothing")
    if parts[0] == "law":
        if all(joint.law is not None for joint in study.joints):
            raise InputError(f"{where}: every joint has a law of its own; a sweep varies the study's [law]")
        if key == MODEL and not study.law.needs_surface:
            raise InputError(
                f'{where}: [law] gives "{study.law.model}" in full; other laws would lack their surface. '
                "Vary them on a study with [surface]"
            )
        if key not in (MODEL, "law.counterbody") and not models:
            check_entries(study.law.kind, [parts[1]])


@dataclass(frozen=True, kw_only=True)
class StudyVariant:
    """A study and its surfaces with some values put in.

    Args:
        study, surfaces: The study, and the surface of each joint.
        forces: Of the bolts [N] (b,), or at all loads (loads, b).
        stiffness: Factor on both stiffnesses of joints, by name [-].
        scales: Factors on the stiffness and the mass of parts, by name [-].
    """

    study: Study
    surfaces: tuple[Surface, ...]
    forces: Array
    stiffness: Mapping[str, float] = field(default_factory=dict)
    scales: Mapping[str, tuple[float, float]] = field(default_factory=dict)

    def with_value(self, key: str, value: Any) -> "StudyVariant":
        """The same with one more value, in SI units, put in."""
        study, parts = self.study, key.split(".")
        room, name = parts[0], parts[-1]
        if room == "surface":
            pairs = zip(study.joints, self.surfaces, strict=True)
            kept = tuple(s if joint.surface is not None else s.with_number(name, value) for joint, s in pairs)
            return replace(self, surfaces=kept)
        if room == "law":
            law = study.law
            own = name in ("model", "counterbody")
            law = replace(law, **{name: value}) if own else replace(law, given={**law.given, name: value})
            return replace(self, study=replace(study, law=law))
        if formed(parts):
            joints = tuple(_with_form(joint, parts, value) for joint in study.joints)
            return replace(self, study=replace(study, joints=joints))
        if room == "part":
            return self.with_scales([parts[1]], **{name: value})
        here = [len(parts) == 2 or thing.name == parts[1] for thing in getattr(study, f"{room}s")]
        if room == "bolt":
            wanted = self.forces * value if name == "factor" else np.full(len(here), value)
            return replace(self, forces=np.where(here, wanted, self.forces))
        which = [joint.name for joint, one in zip(study.joints, here, strict=True) if one]
        if name == "stiffness":
            return replace(self, stiffness={**self.stiffness, **dict.fromkeys(which, value)})
        joints = tuple(replace(j, **{name: value}) if j.name in which else j for j in study.joints)
        return replace(self, study=replace(study, joints=joints))

    def with_scales(self, parts: Iterable[str], *, stiffness: float = 1.0, mass: float = 1.0) -> "StudyVariant":
        """The same with the stiffness and the mass of some parts scaled once more."""
        scales = dict(self.scales)
        for part in parts:
            k, m = scales.get(part, (1.0, 1.0))
            scales[part] = k * stiffness, m * mass
        return replace(self, scales=scales)


def _with_form(joint: JointChoice, key: list[str], value: float) -> JointChoice:
    """The joint with one number of its form changed, where the key is for it."""
    if len(key) == 4 and key[1] != joint.name:
        return joint
    return replace(joint, form=(joint.form or Form()).with_value(key[-1], value))
