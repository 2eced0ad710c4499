"""[material.NAME] and [part.NAME]: what the parts are made of."""

from collections.abc import Mapping

from faying.errors import InputError
from faying.materials import CATALOGUE, STIFFEST, Material
from faying.study.keys.reader import MOST_FRICTION, Table


def read_materials(top: Table) -> dict[str, Material]:
    """Return the catalogue with the materials of the study."""
    materials = dict(CATALOGUE)
    for name, table in top.named("material").items():
        fields = {
            "E": table.quantity("E", "Pa"),
            "nu": table.number("nu"),
            "density": table.quantity("density", "kg/m^3"),
            "yield_strength": table.quantity("yield_strength", "Pa", None),
            "hardness": table.quantity("hardness", "Pa", None),
            "brinell": table.quantity("brinell", "Pa", None),
            "friction": table.within("friction", 0, MOST_FRICTION, None),
            "conductivity": table.quantity("conductivity", "W/(m*K)", None),
            "resistivity": table.quantity("resistivity", "ohm*m", None),
            "bearing_limit": table.quantity("bearing_limit", "Pa", None),
            "expansion": table.quantity("expansion", "1/K", None, positive=False),
            "source": table.text("source", ""),
        }
        table.close()
        if None not in (fields["E"], fields["nu"], fields["density"]):
            try:
                materials[name] = Material(name=name, **fields)
            except InputError as fault:
                top.faults.add(str(fault))
    return materials


def read_parts(top: Table, materials: Mapping[str, Material]) -> dict[str, str]:
    """Return the name of the material of each part."""
    parts: dict[str, str] = {}
    for name, table in top.named("part", required=True).items():
        material = table.text("material")
        if material is not None and material not in materials:
            known = ", ".join(f'"{m}"' for m in materials)
            top.faults.add(f'part.{name}.material = "{material}" is unknown; known are {known}')
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
        table.close()
    return parts
