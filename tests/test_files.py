"""Files appear whole or not at all, also where the disk is full."""

import errno
import os
import subprocess
import sys

import pytest

import faying
from faying.errors import ReadError
from faying.files import read_numbers, write_atomically
from faying.study.template import write


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


def test_a_folder_that_is_not_there(tmp_path):
    with pytest.raises(faying.InputError, match="make it first"):
        write_atomically(tmp_path / "none" / "x", lambda p: p.write_text("x"))


LIMITED = """
import resource, sys
from faying.study import case

def meshed(study, of=case.checked_mesh):
    mesh = of(study)  # the mesher has a process and a file of its own
    resource.setrlimit(resource.RLIMIT_FSIZE, (2**15, 2**15))
    return mesh

case.checked_mesh = meshed
from faying.cli import main
main(sys.argv[1:])
"""


@pytest.mark.skipif(sys.platform == "win32", reason="no limits on file size")
@pytest.mark.parametrize("command", ["run", "modes"])
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
