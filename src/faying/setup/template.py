"""The study that `faying init` writes: every key explained, and a geometry so small that it runs in seconds."""

from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from faying.errors import FayingError, InputError
from faying.files import together, write_atomically, write_text
from faying.surface.scan import Scan

# first line of a study, for editors that know TOML (Taplo, Even Better TOML); `faying schema` writes the file
SCHEMA = "#:schema ./faying.schema.json"
TEXT = """#:schema ./faying.schema.json
# A Faying study. Quantities are text with a unit; plain numbers have no dimension.
# Run it with: faying run {name}
title = "Two blocks and a bolt"

# The parts: solids of a STEP file with the names that the CAD program gave to solids and faces.
[geometry]
step = "{step}"
size = "8 mm"                  # largest element
[geometry.face_size]           # finer where it matters
"upper.joint" = "4 mm"
# A face without a name in the file gets one here, by what it is; `faying faces {step}` lists the faces.
# [geometry.face]
# "upper.joint" = {{ part = "upper", touching = "lower" }}    # or in place of a name: faces = [{{ part = ... }}, ...]
# "upper.top" = {{ part = "upper", normal = "+z" }}           # or number = 3, as the list has it
# "upper.end" = {{ part = "upper", nearest = ["50 mm", "0 mm", "30 mm"] }}   # at most 1 mm away, or within = "5 mm"
# Or a mesh of your own in place of step and size (.inp, .bdf, .msh, .cdb, .vtk, .vtu): its sets are parts and faces.
# mesh = "model.inp"
# unit = "mm"                  # of its coordinates; no such file says
# sets = {{ upper = "ELSET1" }}  # part = element set, where the file's bodies are not the parts

[part.upper]
material = "45 steel"          # from the catalogue (45 steel, S355, EN AW-6082 T6) or a [material.NAME] of yours
[part.lower]
material = "45 steel"

# [material."my steel"]
# E = "210 GPa"
# nu = 0.3
# density = "7850 kg/m^3"
# yield_strength = "355 MPa"
# brinell = "1.67 GPa"         # HB 170: contact solved on a scan needs it for the hardness of small spots
# hardness = "994 MPa"         # of analytic laws; 2.8 times the yield strength where left out
# friction = 0.25

# The rough surface: the scan of one face.
[surface]
scan = "{scan}"      # synthetic; X3P, x,y,z text; more formats with the extra `instruments`
counter = "same"               # the other face: alike but unrelated; "smooth"; or the file of its own scan
# xy_unit = "mm"               # only where the file does not say
# z_unit = "um"
# size = "4 mm x 3 mm"         # or spacing = "5 um", where the file has neither
# method = "psd"               # estimator of D and G; `faying surface` lists them
# ... or the fractal parameters of both faces together, in place of scan and counter.
# D = 2.39                     # fractal dimension, between 2 and 3
# G = "1.53e-10 m"             # fractal roughness, Yan-Komvopoulos convention
# scan_area = "16 mm^2"        # area of the scan that D and G come from

[law]
model = "auto"                 # the contact solved on the scan, or the law nearest to it; `faying models` lists others
counterbody = "part"           # or "rigid": the other body does not yield
# model = "jk"                 # Zhang et al. 2024, with its own keys:
# closure = "consistent"       # or "printed": the numbers of the paper
# loss = "held"                # or "literal"
# cutoff = 0.01                # smallest asperity that counts for stiffness, as a share of a1c'
# substrate = 1.0              # share of the deformation that the asperity takes, or "exact", "computed"

# The same joints under another law, beside the study's own.
# [[alternative]]
# name = "JK"
# law = {{ model = "jk" }}

[[joint]]
name = "joint"
faces = ["upper.joint", "lower.joint"]
springs = "per-area"           # or "per-node": the paper's use, which depends on the mesh
# tangential = "mindlin"       # k_t = k_n 2(1-nu)/(2-nu), whatever the law says; else its own where it has one

[[bolt]]
name = "bolt"
faces = ["upper.seat", "lower.seat"]   # the two seats that head and nut press on
preload = ["8 kN", "15 kN"]            # one or more, rising
# diameter = "8 mm"            # with a material: a shank that resists and weighs, and has a load factor
# material = "45 steel"
# grade = "8.8"                # sets the preload beside the proof load

[modes]
count = 6                      # elastic modes
# solver = "pardiso"           # the fastest one found where left out

# A hammer test to compare with: one row of frequencies for each preload.
# [test]
# source = "who measured it, when"
# frequencies = [["406 Hz", "1126 Hz"], ["410 Hz", "1135 Hz"]]
# direction = [1, 0, 0]        # of the hammer
# points = [["50 mm", "0 mm", "30 mm"]]   # where it hits or the sensor sits
# Or a universal file of modes or FRFs in place of the frequencies.
# file = "test.uff"
# frame = "frame.csv"          # where some of its points lie in the model, if it has a frame of its own
# load = "6 kN"                # the preload to compare at; the last where left out
# tolerance = "2 mm"           # between a point and its node
# Keys for what the file does not say: points, length_unit, direction, quantity.
# What a pair needs: least_mac, greatest_shift.

# Frequency response between points, along directions, at every preload.
# [response]
# from = "5 kHz"
# to = "20 kHz"
# points = 400                 # frequencies
# structural_loss = 0.001      # loss factor of the parts themselves
# [[response.input]]
# point = ["40 mm", "15 mm", "15 mm"]
# direction = [0, 0, 1]
# [[response.output]]
# point = ["-40 mm", "-15 mm", "-15 mm"]
# direction = [0, 0, 1]
"""


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
