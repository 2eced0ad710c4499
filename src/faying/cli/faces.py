"""faying faces FILE"""

from pathlib import Path
from typing import Any

import click

from faying.cli.options import PATH
from faying.output.terminal import folded, indented
from faying.text import json_text

WIDE = 18  # letters of a face's name in the table


@click.command()
@click.argument("geometry", type=PATH)
@click.option("--part", help="Only the faces of this part.")
@click.option("--unit", help='Unit of a mesh file\'s coordinates, such as "mm".')
@click.option("--json", "as_json", is_flag=True, help="Print JSON in SI units.")
def command(geometry: Path, part: str | None, unit: str | None, as_json: bool) -> None:
    """List the faces of GEOMETRY, a STEP or mesh file: number, kind, area, normal, centre, and where parts touch."""
    from faying.setup.face_names import faces

    facts = faces(geometry, unit=unit)
    if part is not None:
        facts = facts.of_part(part)
    click.echo(json_text(facts.to_dict()) if as_json else text(facts))


def text(facts: Any) -> str:
    """One table for each part, and one of the faces that look at each other."""
    lines: list[str] = []
    for one in facts.parts:
        faces = facts.by_part[one.name]
        size = " x ".join(f"{1e3 * (b - a):.4g}" for a, b in zip(one.low, one.high, strict=True))
        lines += [f"{one.name}: {len(faces)} faces, {1e6 * one.volume:.4g} cm3, within {size} mm"]
        named = any(face.name for face in faces)
        head = ["no", *(["name"] if named else []), "kind", "area mm2", "normal", "centre mm", "r mm", "next to"]
        rows = [head, *(_row(face, named) for face in faces)]
        lines += [*indented(rows, left=range(len(head))), ""]
    if facts.contacts:
        lines.append("faces that look at each other")
        rows = [["part", "no", "part", "no", "area mm2", "gap mm"]]
        rows += [
            [c.first[0], str(c.first[1]), c.second[0], str(c.second[1]), f"{1e6 * c.area:.4g}", f"{1e3 * c.gap:.3g}"]
            for c in facts.contacts
        ]
        lines += [*indented(rows, left=range(len(rows[0]))), ""]
    lines += [f"note: {note.text}" for note in facts.notes]
    return folded("\n".join(lines).rstrip())


def _row(face: Any, named: bool) -> list[str]:
    name = face.name if len(face.name) <= WIDE else f"..{face.name[2 - WIDE :]}"
    kind = face.kind if face.hole is None else ("hole" if face.hole else "shaft")
    normal = "" if face.normal is None else _direction(face.normal)
    centre = " ".join(f"{1e3 * x:.4g}" for x in face.centre)
    radius = "" if face.radius is None else f"{1e3 * face.radius:.4g}"
    near = ",".join(map(str, face.neighbours))
    near = near if len(near) <= 10 else near[:8].rpartition(",")[0] + ",.."
    return [str(face.number), *([name] if named else []), kind, f"{1e6 * face.area:.4g}", normal, centre, radius, near]


def _direction(normal: Any) -> str:
    """An axis word, or three numbers."""
    from faying.geometry.selectors import AXES

    words = [word for word, axis in AXES.items() if max(abs(a - b) for a, b in zip(axis, normal, strict=True)) < 1e-6]
    return words[0] if words else " ".join(f"{x:.2f}" for x in normal)
