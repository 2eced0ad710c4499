"""[material.NAME] and [part.NAME]: what the parts are made of."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, Self

import numpy as np

from faying.contact.parameter import Parameter
from faying.errors import InputError
from faying.materials import CATALOGUE, MOST_FRICTION, STIFFEST, Material
from faying.measured.tested import read_test
from faying.study.declaration.declared import NAME, QUANTITY, REQUIRED, Declared, Inner, Key, one_or_more
from faying.study.declaration.reader import Table
from faying.study.declaration.values import quantity
from faying.study.keys.test import QUANTITIES as FRF_QUANTITIES

MODULI = (1e3, 2e12)  # Pa: gels and diamond


def read_materials(top: Table) -> dict[str, Material]:
    """Return the catalogue with the materials of the study."""
    materials = dict(CATALOGUE)
    for name, table in top.named("material").items():
        fields = {key: table.get(key) for key in MATERIAL}
        if None not in (fields["E"], fields["nu"], fields["density"]):
            try:
                materials[name] = Material(name=name, **fields)
            except InputError as fault:
                top.faults.add(str(fault))
    return materials


def named_material(table: Table, materials: Mapping[str, Material], who: str) -> Material | None:
    """Take the material that a bolt, a washer or a pin names; None where there is none, which is a fault if named."""
    name = table.get("material")
    if name is None or name in materials:
        return None if name is None else materials[name]
    known = ", ".join(f'"{one}"' for one in materials)
    table.faults.add(f'{who}: material "{name}" is unknown; the known ones are {known}')
    return None


@dataclass(frozen=True, kw_only=True)
class PartTestChoice:
    """What was measured of a part alone: its mass [kg], and its free modes [Hz] as a list or a file."""

    mass: float | None = None
    frequencies: tuple[float, ...] = ()
    file: Path | None = None
    quantity: str | None = None

    def read(self) -> Self:
        """The test with the frequencies of its file, rising. Raises ReadError and InputError."""
        if self.file is None:
            return self
        found = np.sort(read_test(self.file, quantity=self.quantity).modes.frequencies)
        return replace(self, frequencies=tuple(found.tolist()), file=None, quantity=None)


def read_parts(top: Table, materials: Mapping[str, Material]) -> tuple[dict[str, str], dict[str, PartTestChoice]]:
    """Return the name of the material of each part, and the test of each part that has one."""
    parts: dict[str, str] = {}
    tests: dict[str, PartTestChoice] = {}
    for name, table in top.named("part").items():
        test = PartTestChoice(**{key: table.get(key) for key in ("mass", "frequencies", "file", "quantity")})
        if test.mass is not None or test.frequencies or test.file is not None:
            tests[name] = test
        elif test.quantity is not None:
            top.faults.add(f"part.{name} has quantity, which is of the FRFs in file; give file, or leave it out")
        if test.frequencies and test.file:
            top.faults.add(f"part.{name} has both file and frequencies; give one of them")
        material = table.get("material")
        if material is not None and material not in materials:
            known = ", ".join(f'"{m}"' for m in materials)
            top.faults.add(f'part.{name}.material = "{material}" is unknown; the known ones are {known}')
        elif material is not None and materials[material].density is None:
            top.faults.add(f'part.{name}: material "{material}" has no density; modes need one')
        elif material is not None and materials[material].nu > STIFFEST:
            nu = materials[material].nu
            top.faults.add(
                f'part.{name}: material "{material}" has nu = {nu:g}, and solid elements lock near 0.5; give at most '
                f"{STIFFEST:g}"
            )
        if material is not None:  # else a fault is noted, and nothing may stand in its place
            parts[name] = material
    return parts, tests


def _frequencies(value: Any, name: str) -> tuple[float, ...]:
    if not value:
        raise InputError(f'{name} = {value!r} should be a list of frequencies, for example ["512 Hz", "1.4 kHz"]')
    return tuple(quantity(one, "Hz", name) for one in (value if isinstance(value, list) else [value]))


MATERIAL: Declared = {
    "E": Key.quantity("Pa", "Young's modulus.", REQUIRED, ends=MODULI).varying(short="E"),
    "nu": Key.number("Poisson's ratio, below 0.495 for parts.", REQUIRED),
    "density": Key.quantity("kg/m^3", "Density.", REQUIRED).varying(short="density"),
    "yield_strength": Key.quantity("Pa", "Yield strength; gives the hardness where that is left out."),
    "hardness": Key.quantity(
        "Pa",
        "Hardness of the analytic laws of asperities; 2.8 times the yield strength where left out. Without brinell it "
        "is the hardness of every law, the same for spots of every size.",
    ),
    "brinell": Key.quantity(
        "Pa",
        'Brinell hardness as a pressure: HB 170 is "1.67 GPa". From 1.3 to 7.6 GPa the solved contact and the laws of '
        "conductance take the Vickers hardness that indentations of each size then have; outside of that, this one "
        "number.",
    ),
    "friction": Key.within(0, MOST_FRICTION, "Static coefficient of friction, for the contact law."),
    "conductivity": Key.quantity("W/(m*K)", "Thermal conductivity; gives the conductance of joints."),
    "resistivity": Key.quantity("ohm*m", "Electrical resistivity; gives the conductance of joints."),
    "bearing_limit": Key.quantity("Pa", "Allowable pressure under a bolt head (p_G of VDI 2230)."),
    "expansion": Key.quantity(
        "1/K", "Coefficient of linear thermal expansion; a load that changes temperatures needs it.", positive=False
    ),
    "source": Key.text("Where the numbers come from.", ""),
}
MATERIALS = Inner(
    says="Materials of your own, in addition to those of the catalogue.",
    keys={NAME: Inner(says="One material; parts, bolts and washers name it.", keys=MATERIAL)},
)
PARTS = Inner(
    says="What each part is made of.",
    required=True,
    keys={
        NAME: Inner(
            says="The part with that name in the geometry.",
            keys={
                "material": Key.text(
                    "A material of the catalogue or of the study.", REQUIRED, examples=lambda: CATALOGUE
                ),
                "mass": Key.quantity("kg", "Weighed mass of the part alone; narrows the intervals."),
                "frequencies": Key(
                    "a frequency, or a list of them",
                    one_or_more(QUANTITY),
                    "Measured free modes of the part alone, rigid motions left out; they narrow the intervals.",
                    (),
                    unit="Hz",
                    read=_frequencies,
                ),
                "file": Key.file("Universal file of these modes, or of FRFs of the part, in place of frequencies."),
                "quantity": Key.text("What the FRFs are, where the file does not say.", None, FRF_QUANTITIES),
            },
        )
    },
)
# factors that vary, on the matrices of one part
PART_FACTORS: Declared = {
    "stiffness": Key.of_parameter(Parameter("", "factor on the stiffness of a part", 0)).varying(
        lambda material, factor: replace(material, E=material.E * factor)
    ),
    "mass": Key.of_parameter(Parameter("", "factor on the mass of a part", 0)).varying(
        lambda material, factor: replace(material, density=material.density * factor)
    ),
}
