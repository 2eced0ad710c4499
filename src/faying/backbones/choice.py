"""What is asked of a backbone: the study's settings with those of the call, its preload, friction and files."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from faying.errors import InputError
from faying.study.keys.backbone import BackboneChoice, check_friction
from faying.study.study import Study


def chosen(study: Study, friction: float | Sequence[float] | None, asked: dict[str, Any]) -> BackboneChoice:
    """[backbone] of the study with what is asked for in place of it."""
    given = {name: value for name, value in asked.items() if value is not None}
    if friction is not None:
        given["friction"] = tuple(friction) if isinstance(friction, Sequence) else (friction,)
    return replace(study.backbone or BackboneChoice(), **given)


def names(out: Path, count: int) -> list[Path]:
    """The files of several curves: numbered, but for one alone."""
    return [out] if count == 1 else [out.with_name(f"{out.stem}-{k + 1}{out.suffix}") for k in range(count)]


def friction_of(study: Study, choice: BackboneChoice) -> list[tuple[float, ...]]:
    """Coefficient of each joint for each curve. Raises InputError where a joint has none."""
    if choice.friction:
        return [(value,) * len(study.joints) for value in choice.friction]
    own: list[float] = []
    for joint in study.joints:
        if joint.friction is None:
            raise InputError(
                f"joint {joint.name!r} has no friction, and without it nothing slips; give friction = 0.2 "
                "(--friction 0.2), or friction in its [[joint]] or in [backbone]"
            )
        check_friction(joint.friction)
        own.append(joint.friction)
    return [tuple(own)]
