"""[[joint]]: two faces that meet, with the gap, surface and law of this joint alone."""

from dataclasses import dataclass
from typing import Literal

from faying import units
from faying.joint.gap_map import GapMap, read_gap_map
from faying.study.keys.law import LawChoice
from faying.study.keys.reader import Table, direction, point
from faying.study.keys.surface import SurfaceChoice


@dataclass(frozen=True, kw_only=True)
class JointChoice:
    """Two faces that meet, before there is a mesh to place them on.

    search_distance [m] between faces that count as meeting; surface and law: of this joint alone, those of the study
    where None; gap: the measured distance of the faces before any load.
    """

    name: str
    faces: tuple[str, str]
    springs: Literal["per-area", "per-node"] = "per-area"
    tangential: Literal["law", "mindlin"] | None = None
    friction: float | None = None
    search_distance: float | None = None
    surface: SurfaceChoice | None = None
    law: LawChoice | None = None
    gap: GapMap | None = None

    @classmethod
    def of(cls, table: Table, index: int) -> "JointChoice":
        """Read one [[joint]]."""
        surface, law, gap = table.table("surface"), table.table("law"), table.table("gap")
        choice = cls(
            name=table.text("name", f"joint {index + 1}"),
            faces=tuple(table.texts("faces", 2) or ("", "")),
            springs=table.text("springs", "per-area", ("per-area", "per-node")),
            tangential=table.text("tangential", None, ("law", "mindlin")),
            friction=table.number("friction", None),
            search_distance=table.quantity("search_distance", "m", None),
            surface=None if surface is None else SurfaceChoice.of(surface),
            law=None if law is None else LawChoice.of(law),
            gap=None if gap is None else _gap(gap),
        )
        table.close()
        return choice


def _gap(table: Table) -> GapMap | None:
    """Read the map of a gap: CSV or text of x, y, gap, with the units of the columns and the place of their axes."""
    file = table.file("file")
    xy, gap = table.text("xy_unit"), table.text("gap_unit")
    origin = table.take("origin", point, (0.0, 0.0, 0.0))
    x_axis = table.take("x_axis", direction, (1.0, 0.0, 0.0))
    y_axis = table.take("y_axis", direction, (0.0, 1.0, 0.0))
    table.close()
    if file is None or xy is None or gap is None:
        return None
    return table.made(
        lambda: read_gap_map(
            file,
            xy_unit=units.scale(xy, "m", name="xy_unit"),
            gap_unit=units.scale(gap, "m", name="gap_unit"),
            origin=origin,
            x_axis=x_axis,
            y_axis=y_axis,
        )
    )
