"""A study with other values put in where its numbers may vary."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from faying.contact.build import check_entries
from faying.errors import InputError
from faying.study.keys.surface import Surface
from faying.study.keys.varied import MODEL, number_of, varied
from faying.study.study import Study
from faying.typing import Array


def check_key(study: Study, key: str, *, models: bool, where: str) -> None:
    """InputError where the study has nothing that this key could vary; models: whether the law varies, too."""
    room, _, name = key.partition(".")
    known = {
        "bolt": [bolt.name for bolt in study.bolts],
        "joint": [joint.name for joint in study.joints],
        "part": list(study.parts),
        "material": sorted(set(study.parts.values())),
    }
    if (number := varied(key)) is not None:
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

    def with_value(self, key: str, value: Any) -> "StudyVariant":
        """The same with one more value, in SI units, put in: for all owners of the number, or the one that is named."""
        study = self.study
        if key == MODEL:
            return replace(self, study=replace(study, law=replace(study.law, model=value)))
        number = number_of(key)

        def put(owner: Any, name: str | None = None) -> Any:
            return number.put(owner, value) if number.owner in (None, name) else owner

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
        for part in scaled_parts(study, key):
            material = study.materials[study.parts[part]]
            new, (stiffness, mass) = number.put(material, value), scales.get(part, (1.0, 1.0))
            scales[part] = stiffness * (new.E / material.E), mass * (new.density / material.density)
        return replace(self, scales=scales)


def scaled_parts(study: Study, key: str) -> list[str]:
    """Parts whose stiffness or mass a key varies: one part, or those of one material."""
    number = varied(key)
    if number is None or number.room not in ("part", "material"):
        return []
    return [part for part, material in study.parts.items() if number.owner == {"part": part}.get(number.room, material)]
