"""How far the stiffness of joints lies from each law, by what was measured: the range of a law in every interval."""

from collections.abc import Mapping
from dataclasses import dataclass
from math import log
from typing import final

from faying.case.case import checked_mesh, materials_at, part_of, surfaces_of
from faying.contact.build import AUTO
from faying.distribution import FACTOR_SCORE, Distribution
from faying.fe.mesh import Mesh
from faying.hardness import BRINELL_RANGE
from faying.materials import Material
from faying.study.keys.joint import JointChoice
from faying.study.keys.surface import Surface
from faying.study.study import Study

STEEL = 150e9  # Pa, Young's modulus above which a metal counts as steel: those that were measured have 70 to 120 or 200


@final
@dataclass(frozen=True, kw_only=True)
class LawRange:
    """Measured stiffness over that of one law: lognormal, one factor either way about a median for each class of metal.

    Args:
        hard: median where both faces are of steel or harder [-].
        soft: median where a face is of a soft metal [-].
        factor: from the median to 95 % [-].
    """

    hard: float
    soft: float
    factor: float

    def of(self, *, soft: bool) -> Distribution:
        """The factor on the stiffness of a joint."""
        centre = self.soft if soft else self.hard
        return Distribution(kind="lognormal", centre=centre, spread=log(self.factor) / FACTOR_SCORE)


# by benchmarks/law_range.py, from 42 values of 20 pairs of faces of four sources (docs/theory/measured-over-laws.csv)
SOLVED = LawRange(hard=1.4, soft=0.18, factor=5.8)
LAW_RANGES: Mapping[str, LawRange] = {
    "half-space": SOLVED,
    "CMY": LawRange(hard=1.6, soft=0.16, factor=6.6),
    "Mikic": LawRange(hard=2.6, soft=1.1, factor=3.8),
    "GW": LawRange(hard=2.7, soft=1.1, factor=3.8),
    "GW-CEB": LawRange(hard=3.0, soft=1.7, factor=3.8),
    "GW-KE": LawRange(hard=2.9, soft=1.6, factor=3.8),
    "GW-ZMC": LawRange(hard=2.8, soft=1.6, factor=3.8),
    "GW-JG": LawRange(hard=2.9, soft=1.8, factor=3.9),
    "Persson": LawRange(hard=4.1, soft=1.6, factor=3.9),
    "JK": LawRange(hard=0.26, soft=0.11, factor=4.2),
    "ME": LawRange(hard=0.20, soft=0.16, factor=4.4),
}
FRACTAL = "MB", "WK", "YK"  # of spots like those of JK, which stands for them
# a measured curve: 5 to 95 % of pairs of faces of one source about their median
MEASURED = LawRange(hard=1.0, soft=1.0, factor=3.2)
CURVES = "Power law", "Table"


def law_range(label: str) -> LawRange:
    """The range of a law by its label, as in `faying models`; a law that was not compared has that of the default."""
    if label in CURVES:
        return MEASURED
    return LAW_RANGES["JK"] if label in FRACTAL else LAW_RANGES.get(label, SOLVED)


def is_soft(first: Material, second: Material) -> bool:
    """Whether one of two materials is a metal softer than Brinell's 1.3 GPa that is not a steel.

    A steel of which only a yield strength is known counts as steel, though 2.8 times that strength may be less.
    """
    return any(
        one.bulk_hardness is not None and one.bulk_hardness < BRINELL_RANGE[0] and one.E < STEEL
        for one in (first, second)
    )


def of_joint(study: Study, mesh: Mesh, joint: JointChoice, surface: Surface) -> Distribution:
    """The factor on the stiffness of a joint by its law and its two materials."""
    return law_range(_label(study, joint, surface)).of(soft=is_soft(*materials_at(study, mesh, joint)))


def of_joints(study: Study) -> list[Distribution]:
    """The same of every joint, without a mesh; it is read where materials differ and a face does not name its part."""
    kinds = {is_soft(material, material) for material in map(study.materials.__getitem__, study.parts.values())}
    mesh, out = None, []
    for joint, surface in zip(study.joints, surfaces_of(study), strict=True):
        parts = [part_of(study, face) for face in joint.faces]
        if len(kinds) == 1:
            soft = kinds == {True}
        elif None not in parts:
            rough, other = (study.materials[study.parts[str(part)]] for part in parts)
            soft = is_soft(rough, other)
        else:
            mesh = mesh or checked_mesh(study)
            soft = is_soft(*materials_at(study, mesh, joint))
        out.append(law_range(_label(study, joint, surface)).of(soft=soft))
    return out


def _label(study: Study, joint: JointChoice, surface: Surface) -> str:
    """The law of a joint; the default is the solved contact, or a law close to it, and JK where there is no map."""
    label = study.law_of(joint).model
    if label != AUTO:
        return label
    return "JK" if surface.rough is None or surface.rough.scan is None else "half-space"
