"""What of a study may vary while the matrices of its parts stay, and the study with other values put in."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from faying.contact.build import check_entries, kinds
from faying.contact.parameter import FILE, TABLE, Parameter
from faying.errors import InputError
from faying.joint.form import PARAMETERS, Form
from faying.study.keys.joint import JointChoice
from faying.study.keys.law import OF_SURFACE
from faying.study.keys.surface import Surface
from faying.study.study import Study
from faying.typing import Array

# what a sweep may vary beside the entries of laws: all of it acts on the joints alone
OWN = {
    "surface.D": Parameter("", "fractal dimension", 2, 3),
    "surface.G": Parameter("m", "fractal roughness", 0),
    "surface.scan_area": Parameter("m^2", "area that the scan covers", 0),
    "bolt.preload": Parameter("N", "preload of the bolts", 0),
    "joint.friction": Parameter("", "coefficient of friction", 0, 10, "[)"),
    "joint.stiffness": Parameter("", "factor on both stiffnesses of the joints", 0),
    "law.counterbody": Parameter("text", "what the rough face presses on", choices=("part", "rigid")),
}
MODEL = "law.model"
OF_ONE = {"bolt": ("preload",), "joint": ("stiffness",)}  # keys that one bolt or joint may have, by its name


def swept(key: str) -> Parameter | None:
    """What a sweep key declares, for any law that has it; None where there is no such key."""
    parts = key.split(".")
    if len(parts) == 3 and parts[-1] in OF_ONE.get(parts[0], ()):
        return OWN[f"{parts[0]}.{parts[-1]}"]
    if formed(parts):
        return PARAMETERS.get(parts[-1])
    if key in OWN:
        return OWN[key]
    if parts[0] != "law" or len(parts) != 2 or parts[1] in OF_SURFACE:
        return None
    entries = [kind.law.entries().get(parts[1]) for kind in kinds().values()]
    return next((p for p in entries if p is not None and p.unit not in (FILE, TABLE)), None)


def formed(parts: list[str]) -> bool:
    """Whether a key is joint.form.SHAPE, or joint.NAME.form.SHAPE for one joint."""
    return parts[0] == "joint" and len(parts) in (3, 4) and parts[-2] == "form"


def check_key(study: Study, key: str, *, models: bool, where: str) -> None:
    """InputError where the study has nothing that this key could vary; models: whether the law varies, too."""
    parts = key.split(".")
    for room, things in (("bolt", study.bolts), ("joint", study.joints)):
        one = parts[0] == room and (len(parts) == 4 or (len(parts) == 3 and not formed(parts)))
        names = [thing.name for thing in things]
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
class Point:
    """A study and its surfaces with some values put in.

    Args:
        study, surfaces: The study, and the surface of each joint.
        forces: Of the bolts [N] (b,).
        stiffness: Factor on both stiffnesses of joints, by name [-].
        scales: Factors on the stiffness and the mass of parts, by name [-].
    """

    study: Study
    surfaces: tuple[Surface, ...]
    forces: Array
    stiffness: Mapping[str, float] = field(default_factory=dict)
    scales: Mapping[str, tuple[float, float]] = field(default_factory=dict)

    def with_value(self, key: str, value: Any) -> "Point":
        """The same with one more value, in SI units, put in."""
        study, parts = self.study, key.split(".")
        room, name = parts[0], parts[-1]
        if room == "surface":
            pairs = zip(study.joints, self.surfaces, strict=True)
            kept = tuple(s if joint.surface is not None else _with(s, name, value) for joint, s in pairs)
            return replace(self, surfaces=kept)
        if room == "law":
            law = study.law
            own = name in ("model", "counterbody")
            law = replace(law, **{name: value}) if own else replace(law, given={**law.given, name: value})
            return replace(self, study=replace(study, law=law))
        if formed(parts):
            joints = tuple(_with_form(joint, parts, value) for joint in study.joints)
            return replace(self, study=replace(study, joints=joints))
        if room == "joint" and name == "stiffness":
            which = [joint.name for joint in study.joints] if len(parts) == 2 else [parts[1]]
            return replace(self, stiffness={**self.stiffness, **dict.fromkeys(which, value)})
        if room == "joint":
            return replace(self, study=replace(study, joints=tuple(replace(j, friction=value) for j in study.joints)))
        if len(parts) == 2:
            return replace(self, forces=np.full(len(self.forces), value))
        forces = self.forces.copy()
        forces[[bolt.name for bolt in study.bolts].index(parts[1])] = value
        return replace(self, forces=forces)


def _with_form(joint: JointChoice, key: list[str], value: float) -> JointChoice:
    """The joint with one number of its form changed, where the key is for it."""
    if len(key) == 4 and key[1] != joint.name:
        return joint
    return replace(joint, form=(joint.form or Form()).with_value(key[-1], value))


def _with(surface: Surface, name: str, value: float) -> Surface:
    """The surface with one of D, G and scan_area changed."""
    if surface.rough is None:
        return surface
    inputs = replace(surface.rough.inputs, **{name: value})
    return replace(surface, rough=replace(surface.rough, inputs=inputs))
