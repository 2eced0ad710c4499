"""Files appear whole or not at all, also where the disk is full."""

import builtins
import errno
import io
import os
import pathlib
import signal
import subprocess
import sys

import pytest

import faying
from faying.cli.main import main
from faying.columns import read_numbers
from faying.errors import ReadError
from faying.files import together, uninterrupted, write_atomically
from faying.setup import template
from tests.helpers.studies import write


def test_a_full_disk_leaves_the_old_file(tmp_path):
    target = tmp_path / "result.nc"
    target.write_text("old")

    def fill(temporary):
        temporary.write_text("half")
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    with pytest.raises(faying.InputError, match=r"cannot write .*result.nc: No space left on device"):
        write_atomically(target, fill)
    assert target.read_text() == "old"
    assert [p.name for p in tmp_path.iterdir()] == ["result.nc"]


def test_a_file_is_on_the_disk_before_it_takes_its_name(tmp_path, monkeypatch):
    """A power cut after the renaming would otherwise find a file of the right name without its content."""
    did = []
    sync, move = os.fsync, os.replace
    monkeypatch.setattr(os, "fsync", lambda number: did.append(os.fstat(number).st_size) or sync(number))
    monkeypatch.setattr(os, "replace", lambda *names: did.append("renamed") or move(*names))
    write_atomically(tmp_path / "x", lambda path: path.write_text("12345"))
    assert did == [5, "renamed"]


def test_a_folder_that_is_not_there(tmp_path):
    with pytest.raises(faying.InputError, match="make it first"):
        write_atomically(tmp_path / "none" / "x", lambda p: p.write_text("x"))


LIMITED = """
import resource, sys
sys.dont_write_bytecode = True  # Python would leave cut files of bytecode, and the packages would be broken
from faying.case import case

def meshed(study, of=case.checked_mesh):
    mesh = of(study)  # the mesher has a process and a file of its own
    resource.setrlimit(resource.RLIMIT_FSIZE, (2**15, 2**15))
    return mesh

case.checked_mesh = meshed
from faying.cli import main
main(sys.argv[1:])
"""


@pytest.mark.skipif(sys.platform == "win32", reason="no limits on file size")
@pytest.mark.parametrize("command", [pytest.param("run", marks=pytest.mark.slow), "modes"])
def test_no_half_results_where_writing_stops_short(tmp_path, command):
    """The system itself cuts every file at 32 kB, as a full disk would: the message names the file, none is left."""
    write(tmp_path / "study.toml")
    option = {"run": "--out", "modes": "--export"}[command]
    out = tmp_path / "out"
    done = subprocess.run(
        [sys.executable, "-c", LIMITED, command, str(tmp_path / "study.toml"), option, str(out)],
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 1, done.stderr
    assert f"cannot write {out}" in done.stderr
    assert "Traceback" not in done.stderr
    left = list(out.iterdir()) if out.is_dir() else []  # a folder made for nothing is gone as well
    assert all(path.stat().st_size < 2**15 and not path.name.endswith(".part") for path in left)


@pytest.mark.parametrize("line", ["1,5;2,5;3,5", "1,5 2,5", "1,5\t2", "10;4,5"])
def test_decimal_commas_are_refused(tmp_path, line):
    path = tmp_path / "table.csv"
    path.write_text(f"pressure; stiffness\n{line}\n")
    with pytest.raises(ReadError, match="line 2.*decimal commas; write decimal points"):
        read_numbers(path, len(line.replace(";", " ").replace("\t", " ").split()), "p, k")


@pytest.mark.parametrize("line", ["1,2,3", "1, 2, 3", "1 , 2 , 3", "1;2;3", "1.5;2;3", "1 2 3", "1.5, 2,3", "1,-2,3"])
def test_separators_are_no_decimal_commas(tmp_path, line):
    path = tmp_path / "table.csv"
    path.write_text(line + "\n")
    assert read_numbers(path, 3, "three numbers").shape == (1, 3)


def files_of(folder):
    return {path.name: path.read_text() for path in sorted(folder.rglob("*"))}


@pytest.mark.parametrize("there", [True, False])
@pytest.mark.parametrize("fault", [KeyboardInterrupt, faying.InputError("no"), OSError("disk")])
def test_files_appear_together_or_not_at_all(tmp_path, there, fault):
    folder = tmp_path / "deep" / "results"
    if there:
        folder.mkdir(parents=True)
        (folder / "result.nc").write_text("old")
        (folder / "mine.txt").write_text("mine")
    before = files_of(tmp_path) if not there else files_of(folder)

    def stopped():
        with together(folder, "remedy") as hidden:
            (hidden / "result.nc").write_text("new")
            raise fault

    with pytest.raises(type(fault) if isinstance(fault, Exception) else fault):
        stopped()
    assert (files_of(folder) if there else files_of(tmp_path)) == before
    assert there or not folder.parent.exists()
    with together(folder, "remedy") as hidden:
        for name in ("result.nc", "report.html"):
            (hidden / name).write_text("new")
        assert not there or (folder / "result.nc").read_text() == "old"
    mine = {"mine.txt": "mine"} if there else {}
    assert files_of(folder) == {"result.nc": "new", "report.html": "new"} | mine


def test_a_fault_names_the_place_where_the_file_would_have_been(tmp_path):
    def full(temporary):
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    target = tmp_path / "out"
    with pytest.raises(faying.InputError) as fault, together(target, "remedy") as hidden:
        write_atomically(hidden / "result.nc", full)
    assert str(fault.value) == f"cannot write {target / 'result.nc'}: No space left on device"
    (tmp_path / "file").write_text("")
    with pytest.raises(faying.InputError, match="a file has this name; remedy"), together(tmp_path / "file", "remedy"):
        raise AssertionError


def test_an_interruption_waits_for_the_files_and_then_counts():
    done = []
    before = signal.signal(signal.SIGINT, signal.default_int_handler)  # a job in the background ignores it

    def stopped():
        with uninterrupted():
            signal.raise_signal(signal.SIGINT)
            done.append(True)

    try:
        with pytest.raises(KeyboardInterrupt):
            stopped()
    finally:
        signal.signal(signal.SIGINT, before)
    assert done == [True]


STOPPED = """
import os, signal, sys, time
signal.signal(signal.SIGINT, signal.default_int_handler)  # a job in the background ignores it
from faying import style

def wait(*given):
    print("drawing", flush=True)
    time.sleep(60)

style.drawn.__wrapped__.__code__ = wait.__code__
style.time = time
from faying.cli import main
main(sys.argv[1:])
"""


@pytest.mark.skipif(sys.platform == "win32", reason="signals of POSIX")
@pytest.mark.parametrize("number", [signal.SIGTERM, pytest.param(signal.SIGINT, marks=pytest.mark.slow)])
def test_a_run_that_is_stopped_while_it_writes_leaves_what_was_there(tmp_path, number):
    """The data are written when the first figure begins: neither they nor a new folder stay."""
    write(tmp_path / "study.toml")
    out = tmp_path / "out"
    out.mkdir()
    (out / "result.nc").write_text("old")
    command = [sys.executable, "-c", STOPPED, "run", str(tmp_path / "study.toml"), "--out", str(out)]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as process:
        assert process.stdout is not None
        assert process.stdout.readline() == "drawing\n"
        assert any(path.name == "result.nc" for path in out.glob(".*/*"))
        process.send_signal(number)
        _, said = process.communicate(timeout=30)
    assert process.returncode == 1
    assert said.endswith("faying: interrupted\n")
    assert "Traceback" not in said
    assert files_of(out) == {"result.nc": "old"}


LAW = ["law", "--D", "2.39", "--G", "1.53e-10 m", "--scan-area", "16 mm^2", "--material", "45 steel"]
COMMANDS = {
    "init": lambda here, there: ["init", str(there / "study.toml")],
    "new": lambda here, there: ["new", str(here / "two-blocks.step"), "--yes", "--out", str(there / "study.toml")],
    "law --plot": lambda here, there: [*LAW, "--plot", str(there / "law.png")],
    "law --csv": lambda here, there: [*LAW, "--csv", str(there / "law.csv")],
    "surface --plot": lambda here, there: ["surface", str(here / "surface.x3p"), "--plot", str(there / "s.png")],
    "run": lambda here, there: ["run", str(here / "study.toml"), "--out", str(there / "results")],
    "run in a folder": lambda here, there: ["run", str(here / "study.toml"), "--out", str(there)],
    "sweep": lambda here, there: [
        *["sweep", str(here / "study.toml"), "--set", "joint.friction=0.1:0.2:2", "--out", str(there / "sweep.nc")]
    ],
}


@pytest.fixture(scope="module")
def here(tmp_path_factory):
    folder = tmp_path_factory.mktemp("here")
    template.write(folder / "study.toml")
    return folder


@pytest.mark.parametrize(
    ("command", "reason"),
    [
        *((name, "EROFS") for name in COMMANDS),
        *((name, "ENOSPC") for name in COMMANDS if not name.startswith("run")),
        ("new", "EACCES"),
    ],
)
def test_a_folder_that_cannot_be_written(here, tmp_path, monkeypatch, capsys, command, reason):
    """As a read-only mount answers, a full disk and a folder of somebody else: all makes and moves in it fail."""
    there = tmp_path / "there"
    there.mkdir()
    (there / "mine.txt").write_text("mine")
    number = getattr(errno, reason)
    full = reason == "ENOSPC"

    def refusing(do, moves):
        def done(path, *rest, **named):
            inside = isinstance(path, str | os.PathLike) and there in pathlib.Path(path).parents
            writes = moves or bool(rest[:1] and isinstance(rest[0], str) and set(rest[0]) & set("wax+"))
            writes = writes or bool(rest[:1] and isinstance(rest[0], int) and rest[0] & (os.O_WRONLY | os.O_RDWR))
            if inside and writes:
                raise OSError(number, os.strerror(number), str(path))
            return do(path, *rest, **named)

        return done

    for where, name, moves in (
        (os, "mkdir", True),
        (os, "replace", True),
        (os, "rename", True),
        # what was made on a full disk can be removed
        *(((os, "unlink", True), (os, "rmdir", True)) if not full else ()),
        (io, "open", False),
        (os, "open", False),
        (builtins, "open", False),
    ):
        if not (full and name == "mkdir"):
            monkeypatch.setattr(where, name, refusing(getattr(where, name), moves))
    with pytest.raises(SystemExit) as stop:
        main(COMMANDS[command](here, there))
    monkeypatch.undo()
    assert stop.value.code == 1
    said = capsys.readouterr().err.splitlines()[-1]
    assert said.startswith("faying: cannot ")
    assert os.strerror(number) in said
    assert ".part" not in said.replace("sweep.nc.part", "")
    assert {path.name for path in there.iterdir()} == {"mine.txt"}


def test_a_figure_makes_the_folder_that_it_goes_into(tmp_path):
    from matplotlib.figure import Figure

    from faying.style import save

    file = save(Figure(), tmp_path / "results" / "x.svg")
    assert file.read_text().lstrip().startswith("<")
    (tmp_path / "taken").write_text("a file")
    with pytest.raises(faying.InputError, match="cannot make the folder .*taken: .*another place"):
        save(Figure(), tmp_path / "taken" / "x.svg")
