"""The study that `faying init` writes: every key explained, and a geometry so small that it runs in seconds."""

from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from faying.errors import FayingError, InputError
from faying.files import together, write_atomically, write_text
from faying.surface.scan import Scan

# first line of a study, for editors that know TOML (Taplo, Even Better TOML); `faying schema` writes the file
SCHEMA = "#:schema ./faying.schema.json"
# braces are doubled for `str.format`
TEXT = Path(__file__).with_name("template.toml").read_text(encoding="utf-8")


def blocks(path: Path) -> None:
    """Write a STEP file of two blocks, 80 x 30 x 15 mm each, with a clearance hole and two bolt seats."""
    from faying.geometry.cad import kernel, write_step

    kernel()  # names the system's packages where a library is missing
    from netgen.occ import Axes, Axis, Box, Cylinder, Glue, WorkPlane, X, Z

    def block(name: str) -> object:
        solid = Box((-40, -15, 0), (40, 15, 15)) - Cylinder((0, 0, -1), Z, r=4.5, h=17)
        ring = WorkPlane(Axes((0, 0, 15), n=Z, h=X)).Circle(8).Face()
        solid = Glue([solid, ring]).solids[0]
        for face in solid.faces:
            face.name = ""
            if abs(face.center.z) < 1e-9:
                face.name = f"{name}.joint"
            elif abs(face.center.z - 15) < 1e-9 and face.mass < 300:
                face.name = f"{name}.seat"
        solid.name = name
        return solid

    upper, lower = block("upper"), block("lower").Rotate(Axis((0, 0, 0), X), 180)  # type: ignore[attr-defined]
    lower.name = "lower"
    write_step(path, [upper, lower])


def surface(path: Path) -> None:
    """Write a synthetic scan of a fine finish as X3P: 3.2 mm square, rms height 0.5 um, waves up to 0.1 mm.

    It is as wide and as fine as the contact needs that is solved on it: at 4 MPa more than ten spots touch, half of the
    stiffness is on spots of four points or more, and half of the points give k_n within a quarter.
    """
    from faying.surface.files.write import write_scan
    from faying.surface.synthesize import spectral

    scan = spectral((640, 640), spacing=5e-6, D=2.05, Rq=0.5e-6, longest=1e-4, seed=7)
    assert isinstance(scan, Scan)
    with TemporaryDirectory() as folder:  # the writer goes by the suffix
        path.write_bytes(write_scan(scan, Path(folder) / "surface.x3p", precision="F").read_bytes())


def write(study: Path, *, force: bool = False) -> list[Path]:
    """Write the study, its geometry and its scan; InputError where a file of other content exists, unless `force`."""
    if not study.name or study.is_dir():
        raise InputError(f"{study} is a folder; name the study's file, for example {study / 'study.toml'}")
    step, scan = study.with_name("two-blocks.step"), study.with_name("surface.x3p")
    text = TEXT.format(name=study.name, step=step.name, scan=scan.name)
    kept = not force and step.exists() and _same_blocks(step)
    measured = not force and scan.exists() and _same_heights(scan)
    for path, same in (
        (study, not study.exists() or _text(study) == text),
        (step, kept or not step.exists()),
        (scan, measured or not scan.exists()),
    ):
        if not (same or force):
            raise InputError(
                f"{path} exists already, with other content; name another file, or replace it with --force"
            )
    if not study.parent.is_dir():
        raise InputError(f"no folder {study.parent} to write {study.name} in; make it first")
    with together(study.parent, "name a file elsewhere") as folder:
        if not kept:
            write_atomically(folder / step.name, blocks)
        if not measured:
            write_atomically(folder / scan.name, surface)
        write_text(folder / study.name, text)
    return [step, scan, study]


def _same_heights(scan: Path) -> bool:
    """Whether a file holds the scan that `surface` writes."""
    from faying.surface.files.read import read_scan

    with TemporaryDirectory() as folder:
        fresh = Path(folder) / "surface.x3p"
        surface(fresh)
        try:
            return bool(np.array_equal(read_scan(scan).heights, read_scan(fresh).heights))
        except FayingError:
            return False


def _same_blocks(step: Path) -> bool:
    """Whether a file is the one that `blocks` writes."""
    from faying.geometry.cad import without_time

    with TemporaryDirectory() as folder:
        blocks(Path(folder) / "fresh.step")
        return without_time(_text(step)) == _text(Path(folder) / "fresh.step")


def _text(path: Path) -> str:
    try:
        return path.read_text(encoding="utf-8", errors="replace")
    except OSError:  # a folder, for example
        return ""
