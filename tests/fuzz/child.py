"""Reads inputs named on standard input, one "reader<TAB>path" a line, and answers each with a line of JSON.

An answer is {"outcome": "read" | "refused" | "fault", "text": ...}. A crash, a hang or a want of memory shows in the
parent: the answer does not come.
"""

import contextlib
import io
import json
import resource
import sys
import tempfile
import tomllib
import traceback
import warnings
from pathlib import Path

from faying import FayingError

MEMORY = 2 * 2**30  # beyond what the imports take


def scan(path, **given):
    from faying import read_scan

    return read_scan(path, **given).heights.size


def uff(path):
    from faying import read_uff

    file = read_uff(path)
    size = len(file.functions) + len(file.shapes)
    for read in (file.modes, file.frf):
        try:
            read()
        except FayingError:
            continue
    return size


def frf_text(path):
    from faying.measured.text import read_frf_text

    return read_frf_text([path], quantity="accelerance", frequency_step=1.0).values.size


def points(path):
    from faying.measured.mapping import read_points

    return len(read_points(path))


def numbers(path):
    from faying.columns import read_numbers

    return len(read_numbers(Path(path), 2, "p, k"))


def record(path):
    from faying.measured.ring_down import read_record

    return len(read_record(path)[0])


def form(path):
    from faying.form.gap_map import read_heights

    return len(read_heights(Path(path))[1])


def tree(path):
    from faying import netcdf

    return len(netcdf.read(Path(path)).variables)


def arrays(path):
    from faying import ReadError
    from faying.files import load_arrays

    found = load_arrays(Path(path))
    if found is None:
        raise ReadError(f"{path}: is not as it was written")
    return len(found)


def mesh(path):
    from faying import read_mesh

    return len(read_mesh(path, unit="mm").points)


def matrices(path, **given):
    from faying import read_matrices

    return read_matrices(path, stiffness_unit="N/m", mass_unit="kg", **given)[0].nnz


def beside(path, name):
    return str(Path(path).with_name(name))


def study(path):
    from faying.study import Study

    Study.read(path)
    return 1


def result(path):
    import faying

    return len(repr(faying.load(path)))


def new(path):
    """What `faying new` writes of a mesh file, read as a study."""
    from faying.setup.new import Answers, find, study_text
    from faying.study import Study

    out = Path(path).with_name("new.toml")
    text, _ = study_text(find(Path(path), "mm"), Path(path), out, Answers(scan=Path(path).with_name("a.csv")))
    try:
        Study.from_dict(tomllib.loads(text), folder=out.parent, where="new.toml")
    except FayingError as fault:
        missing = ("is missing",)  # what the user fills in
        if not any(word in str(fault) for word in missing):
            raise AssertionError(f"its own study is refused: {fault}") from None
    return len(text)


def command(words, path):
    """A command in this process, in a folder of its own."""
    from faying.cli.main import cli

    with tempfile.TemporaryDirectory(dir=Path(path).parent) as folder:
        filled = [str(path) if word == "FILE" else word.replace("OUT", folder) for word in words]
        with contextlib.redirect_stdout(io.StringIO()) as out, contextlib.redirect_stderr(io.StringIO()):
            cli.main(args=filled, standalone_mode=False)
    return len(out.getvalue()) + 1


def attach(path):
    law = beside(path, "law-study.toml")
    words = ["attach", "FILE", "--face-a", "p0.right", "--face-b", "p1.left", "--unit", "mm", "--law", law]
    return command([*words, "--pressure", "5 MPa", "--to", "calculix", "--out", "OUT/joint"], path)


def condense(path):
    return command(["condense", "FILE", "--json", "--progress", "none"], path)


def body(path):
    """A request of the page with a mutated body, to each route but those that start work; it answers, or names a fault.

    What is saved of it as a file is then asked about as a study, a scan and a geometry.
    """
    from faying.app.project import Project
    from faying.app.routes import ROUTES, Request, Session, answered

    data, size = Path(path).read_bytes(), 0
    query = {"name": "study.toml", "of": "study", "along": "x", "at": "0.5", "window": "0,0,1,1"}
    query |= {"first": "1", "second": "2", "replace": "yes"}
    with tempfile.TemporaryDirectory(dir=Path(path).parent) as folder:
        session = Session(Project.at(Path(folder)))
        for method, route in ROUTES:
            if (method, route) in (("POST", "job"), ("POST", "example"), ("POST", "new")) or route in ("scan", "laws"):
                continue
            answer = answered(session, method, route, Request(query=query, body=io.BytesIO(data), size=len(data)))
            size += len(answer)
            assert b"a fault inside Faying" not in answer, answer
            json.loads(answer, parse_constant=lambda word: 1 / 0)  # JSON never holds NaN
        session.close()
    return size


READERS = {
    "result": result,
    "new": new,
    "attach": attach,
    "condense": condense,
    "body": body,
    "scan": scan,
    "scan units": lambda path: scan(path, xy_unit="mm", z_unit="um"),
    "scan matrix": lambda path: scan(path, z_unit="nm", size=40e-6),
    "uff": uff,
    "frf text": frf_text,
    "points": points,
    "numbers": numbers,
    "mesh": mesh,
    "record": record,
    "form": form,
    "netcdf": tree,
    "arrays": arrays,
    "mtx": lambda path: matrices(path, mass=beside(path, "m.mtx"), dofs=beside(path, "dofs.txt")),
    "npz": lambda path: matrices(path, mass=beside(path, "m.npz"), dofs=beside(path, "dofs.txt")),
    "sti": matrices,
    "study": study,
}


def main():

    import faying
    from faying.surface.files import instruments

    instruments._library()

    faying.read_mesh, faying.read_matrices, faying.read_scan, faying.read_uff, faying.Study  # noqa: B018  loaded now
    taken = int(Path("/proc/self/statm").read_text().split()[0]) * resource.getpagesize()
    resource.setrlimit(resource.RLIMIT_AS, (taken + MEMORY, taken + MEMORY))
    warnings.simplefilter("ignore")
    for line in sys.stdin:
        reader, path = line.rstrip("\n").split("\t")
        try:
            answer = {"outcome": "read", "text": str(READERS[reader](path))}
        except FayingError as fault:
            answer = {"outcome": "refused", "text": str(fault)}
        except BaseException as fault:
            last = traceback.extract_tb(fault.__traceback__)
            ours = [f"{Path(f.filename).name}:{f.lineno}" for f in last if "faying" in f.filename][-2:]
            answer = {"outcome": "fault", "text": f"{type(fault).__name__}: {str(fault)[:120]} at {' < '.join(ours)}"}
        print(json.dumps(answer), flush=True)


if __name__ == "__main__":
    main()
