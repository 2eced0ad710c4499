"""Small valid inputs of every reader, written into a folder; each with the name of its reader in `child.READERS`."""

import json
import zipfile

import numpy as np
import scipy.sparse as sp
from scipy.io import mmwrite

from faying import FRF, write_scan, write_uff
from faying.measured.modes import ModeSet
from faying.surface.synthesize import spectral
from tests.helpers import meshfiles
from tests.helpers.boxes import row, stack

STUDY = (
    meshfiles.STUDY
    + """
[law]
model = "jk"
shear_ratio = 0.2
[[mass]]
face = "p0.left"
mass = "20 g"
[response]
from = "1 kHz"
to = "8 kHz"
points = 20
[[response.input]]
point = ["1 mm", "2 mm", "0 mm"]
direction = [0, 0, 1]
[[response.output]]
point = ["1 mm", "2 mm", "0 mm"]
direction = [0, 0, 1]
"""
)


MORE_KEYS = """
[uncertain]
preload = { scatter = "25 %" }
stiffness = { distribution = "lognormal", median = 1, sd_ln = 0.6 }
E = "200 GPa +- 4 GPa"
friction = "0.1 to 0.2"
[backbone]
mode = 2
amplitude = ["50 m/s^2", "2000 m/s^2"]
friction = 0.2
harmonics = 1
"""
FORM = """
[joint.form]
crown_along = "2 um"
crown_across = "1 um"
"""


SYSTEMS = (
    "    -1\n    18\n         1         0         0         8         1\nSENSOR\n"
    + "".join(f"{v:13.5e}" for v in (0, 0, 0, 0, 1, 0))
    + "\n"
    + "".join(f"{v:13.5e}" for v in (0, 1, 1))
    + "\n    -1\n    -1\n    15\n"
    + "".join(f"{n:10d}{n - 1:10d}{1:10d}{8:10d}{n / 10:13.5e}{0:13.5e}{0:13.5e}\n" for n in (1, 2))
    + "    -1\n    -1\n  2414\n         1\nMode 1\n         1\nNONE\nNONE\nNONE\nNONE\nNONE\n"
    + "         1         2         2         8         2         3\n"
    + "         0" * 8
    + "\n         0         0\n"
    + "".join(f"{v:13.5e}" for v in (0, 100, 0, 1, 0.01, 0))
    + "\n"
    + "".join(f"{0:13.5e}" for _ in range(6))
    + "\n         1\n"
    + "".join(f"{v:13.5e}" for v in (0, 0, 1))
    + "\n         2\n"
    + "".join(f"{v:13.5e}" for v in (0, 0, -1))
    + "\n    -1\n"
)
# what stands beside the geometry in the decks of bolted joints
MORE = """*SURFACE, NAME=nodes, TYPE=NODE
NALL
*NSET, NSET=far, GENERATE
1, 5000
*EQUATION
2
1, 1, 1., 2, 1, -1.
*SURFACE, NAME=cut
5, S2
*PRE-TENSION SECTION, SURFACE=cut, NODE=1
0., 0., 1.
*TIE, NAME=t
cut, cut
"""


def scans(folder):
    scan = spectral((20, 24), spacing=(2e-6, 3e-6), D=2.4, Rq=1e-6, seed=1)
    for precision in "FI":
        yield "scan", write_scan(scan, folder / f"{precision}.x3p", precision=precision)
    with zipfile.ZipFile(folder / "F.x3p") as old, zipfile.ZipFile(folder / "stored.x3p", "w") as new:
        for name in old.namelist():
            new.writestr(name, old.read(name))
    yield "scan", folder / "stored.x3p"
    yield "scan units", write_scan(scan, folder / "a.csv", xy_unit="mm", z_unit="um")
    headed = folder / "headed.csv"
    headed.write_text("x [mm],y [mm],z [um]\n" + (folder / "a.csv").read_text())
    yield "scan", headed
    np.savetxt(folder / "matrix.txt", scan.heights[:12] * 1e9, fmt="%.4f", delimiter="\t")
    yield "scan matrix", folder / "matrix.txt"
    line = spectral(60, spacing=1e-6, D=2.4, Rq=1e-6)
    yield "scan units", write_scan(line, folder / "line.txt", xy_unit="um", z_unit="nm")


def tests_of_hammers(folder):
    rng = np.random.default_rng(1)
    positions = {k: tuple(rng.uniform(0, 1, 3)) for k in (1, 2, 3)}
    frf = FRF(
        frequency=np.arange(1.0, 21.0),
        values=rng.standard_normal((3, 1, 20)) + 1j * rng.standard_normal((3, 1, 20)),
        outputs=((1, "x"), (2, "-z"), (3, "z")),
        inputs=((1, "z"),),
        quantity="accelerance",
        positions=positions,
    )
    modes = [
        ModeSet(
            frequencies=np.array([100.0, 250.0]),
            loss_factors=np.array([0.01, 0.02]),
            shapes=shapes,
            dofs=tuple((k, d) for k in (1, 2, 3) for d in "xyz"),
            positions=positions,
        )
        for shapes in (rng.standard_normal((2, 9)) + 0j, rng.standard_normal((2, 9)) + 1j * rng.standard_normal((2, 9)))
    ]
    yield "uff", write_uff(folder / "frf.uff", frf)
    yield "uff", write_uff(folder / "real.uff", modes[0])
    yield "uff", write_uff(folder / "complex.uff", modes[1], frf)
    table = np.column_stack([frf.frequency, frf.values[0, 0].real, frf.values[0, 0].imag])
    np.savetxt(folder / "frf.csv", table, fmt="%.8g", delimiter=",", header="f,re,im", comments="")
    yield "frf text", folder / "frf.csv"
    (folder / "frf.txt").write_text("\n".join(str(complex(v)) for v in frf.values[0, 0]))
    yield "frf text", folder / "frf.txt"
    (folder / "points.csv").write_text(
        "point,x [mm],y [mm],z [mm]\n" + "\n".join(f"{k},{k}.5,{2 * k},0" for k in range(1, 9))
    )
    yield "points", folder / "points.csv"
    polar = np.column_stack([frf.frequency / 1e3, np.abs(table[:, 1] + 1j * table[:, 2]), 0 * frf.frequency + 30])
    head = "frequency [kHz],magnitude [dB re 1 g/N],phase [deg]"
    np.savetxt(folder / "polar.csv", polar, fmt="%.8g", delimiter=",", header=head, comments="")
    yield "frf text", folder / "polar.csv"
    lines = [f"{k / 1000},{np.sin(k):.6f}" for k in range(40)]
    (folder / "decay.csv").write_text("\n".join(["time [ms],acceleration [m/s^2]", *lines, ""]))
    yield "record", folder / "decay.csv"
    grid = [f"{x},{y},{np.sin(x) + y:.5f}" for x in range(6) for y in range(5)]
    (folder / "form.csv").write_text("\n".join(["x [mm],y [mm],z [um]", *grid, ""]))
    yield "form", folder / "form.csv"
    (folder / "systems.uff").write_text(SYSTEMS)
    yield "uff", folder / "systems.uff"
    (folder / "table.csv").write_text(
        "pressure,stiffness\n" + "\n".join(f"{k}e6, {k**0.5:.5f}e13" for k in range(1, 12))
    )
    yield "numbers", folder / "table.csv"


def meshes(folder):
    mesh = row([0.05, 0.04], [2, 1], kinds=("hex8", "tet10"), sections=((2, 1), (2, 1)), width=0.02, height=0.01)
    for name, text in {
        "flat.inp": meshfiles.abaqus(mesh),
        "bolted.inp": meshfiles.abaqus(mesh) + MORE,
        "assembly.inp": meshfiles.assembly(mesh),
        "small.bdf": meshfiles.nastran(mesh),
        "two.msh": meshfiles.gmsh(mesh),
        "four.msh": meshfiles.gmsh(mesh, version="4.1"),
        "a.cdb": meshfiles.ansys(mesh),
        "u.unv": meshfiles.unv(mesh),
    }.items():
        (folder / name).write_text(text)
        yield "mesh", folder / name
    for version in ("2.2", "4.1"):
        path = folder / f"binary-{version[0]}.msh"
        path.write_bytes(meshfiles.gmsh_binary(mesh, version=version))
        yield "mesh", path


def matrices(folder):
    from faying import Material
    from faying.fe.elasticity import assemble

    mesh = stack([0.02], [2], width=0.01, height=0.01, sections=[(1, 1)])
    K, M = (sp.csr_matrix(A) for A in assemble(mesh, {"p0": Material(name="s", E=2e11, nu=0.3, density=7800.0)})[:2])
    mmwrite(folder / "k.mtx", K, precision=12)
    mmwrite(folder / "m.mtx", M, precision=12)
    nodes = np.repeat(np.arange(1, K.shape[0] // 3 + 1), 3)
    (folder / "dofs.txt").write_text(
        "".join(f"{n} {d}\n" for n, d in zip(nodes, np.tile([1, 2, 3], len(nodes)), strict=False))
    )
    yield "mtx", folder / "k.mtx"
    for name, A in (("k.npz", K), ("m.npz", M)):
        sp.save_npz(folder / name, A)
    yield "npz", folder / "k.npz"
    for name, A in (("job.sti", K), ("job.mas", M)):
        low = sp.tril(A).tocoo()
        lines = [f"{i + 1} {j + 1} {v:.12e}" for i, j, v in zip(low.row, low.col, low.data, strict=True)]
        (folder / name).write_text("\n".join(lines) + "\n")
    (folder / "job.dof").write_text(
        "".join(f"{n}.{d}\n" for n, d in zip(nodes, np.tile([1, 2, 3], len(nodes)), strict=False))
    )
    yield "sti", folder / "job.sti"


def studies(folder):
    (folder / "study.toml").write_text(STUDY)
    mesh = row([0.05, 0.04], [2, 1], kinds=("hex8", "hex8"), sections=((2, 1), (2, 1)), width=0.02, height=0.01)
    (folder / "model.inp").write_text(meshfiles.abaqus(mesh))
    yield "study", folder / "study.toml"
    (folder / "more.toml").write_text(STUDY + MORE_KEYS)
    yield "study", folder / "more.toml"
    (folder / "form.toml").write_text(STUDY.replace("[[bolt]]", FORM + "[[bolt]]", 1))
    yield "study", folder / "form.toml"
    (folder / "law-study.toml").write_text(meshfiles.STUDY)
    for name in ("attach.inp", "new.inp"):
        (folder / name).write_text(meshfiles.abaqus(mesh) + ("" if name[0] == "a" else MORE))
        yield name.partition(".")[0], folder / name
    (folder / "condense.toml").write_text(meshfiles.STUDY)
    yield "condense", folder / "condense.toml"
    (folder / "body.json").write_text(
        json.dumps({"text": STUDY, "name": "study.toml", "before": "", "arguments": ["run"]})
    )
    yield "body", folder / "body.json"


def records(folder):
    from faying import files, netcdf

    tree = netcdf.Group(
        variables={"a": netcdf.Variable(dims=("n", "k"), values=np.arange(60.0).reshape(20, 3))},
        groups={"g": netcdf.Group(variables={"b": netcdf.Variable(dims=("n",), values=np.arange(20))})},
    )
    yield "netcdf", netcdf.write(folder / "tree.nc", tree)
    from tests.helpers.results import small_result

    yield "result", small_result().save(folder / "result.nc")
    sealed = (folder / "result.nc").read_bytes()
    (folder / "foreign.nc").write_bytes(sealed[:-78])  # without its checksum HDF5 reads it
    yield "result", folder / "foreign.nc"
    yield "arrays", files.write_arrays(folder / "a.npz", {"a": np.arange(50.0), "b": np.eye(4)})


def written(folder):
    """(reader, path) of every seed."""
    return [
        *scans(folder),
        *tests_of_hammers(folder),
        *meshes(folder),
        *matrices(folder),
        *studies(folder),
        *records(folder),
    ]
