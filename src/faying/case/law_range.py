"""How far the stiffness of joints lies from each law, by what was measured: the range of a law in every interval."""

from faying.case.case import materials_at
from faying.contact.build import AUTO, find
from faying.contact.measured_range import MeasuredRange
from faying.distribution import Distribution
from faying.fe.mesh import Mesh
from faying.hardness import BRINELL_RANGE
from faying.materials import Material
from faying.study.keys.joint import JointChoice
from faying.study.keys.surface import Surface
from faying.study.study import Study

STEEL = 150e9  # Pa, Young's modulus above which a metal counts as steel: those that were measured have 70 to 120 or 200


def law_range(label: str) -> MeasuredRange | None:
    """The range of a law by its label, as in `faying models`; None for a law that was not compared."""
    return find(label).law.measured_ranges.get(label)


def is_soft(first: Material, second: Material) -> bool:
    """Whether one of two materials is a metal softer than Brinell's 1.3 GPa that is not a steel.

    A steel of which only a yield strength is known counts as steel, though 2.8 times that strength may be less.
    """
    return any(
        one.bulk_hardness is not None and one.bulk_hardness < BRINELL_RANGE[0] and one.E < STEEL
        for one in (first, second)
    )


def of_joint(study: Study, mesh: Mesh, joint: JointChoice, surface: Surface) -> Distribution | None:
    """The factor on the stiffness of a joint by its law and its two materials; None for a law that was not compared."""
    found = law_range(_label(study, joint, surface))
    return None if found is None else found.of(soft=is_soft(*materials_at(study, mesh, joint)))


def _label(study: Study, joint: JointChoice, surface: Surface) -> str:
    """The law of a joint; the default is the solved contact, or a law close to it, and JK where there is no map."""
    label = study.law_of(joint).model
    if label != AUTO:
        return label
    return "JK" if surface.rough is None or surface.rough.scan is None else "half-space"
