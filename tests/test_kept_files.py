"""Files that Faying keeps: whole, as they were written, or not used; foreign ones cannot hang or kill it."""

import errno
import json
import os
import re
import shutil
import signal
import socket
import subprocess
import sys
import time
from contextlib import contextmanager
from pathlib import Path

import h5netcdf
import numpy as np
import pytest

import faying
from faying import files, netcdf
from faying.cli.main import main
from faying.identify.sampling import points
from faying.study import part_folder
from faying.text import json_text

ROOT = Path(__file__).parent.parent
BLOCKS = ROOT / "examples" / "two-blocks"
ARRAYS = {"a": np.arange(200.0), "b": np.eye(3), "words": np.array(["one", "two"])}


def damaged(data, rng):
    """One bit flipped, a stretch of zeros, or an end that is cut."""
    out = bytearray(data)
    kind = rng.integers(3)
    if kind == 0:
        out[rng.integers(len(out))] ^= 1 << rng.integers(8)
    elif kind == 1:
        at = rng.integers(len(out))
        out[at : at + 64] = bytes(len(out[at : at + 64]))
    else:
        del out[rng.integers(1, len(out)) :]
    return bytes(out)


def test_damaged_arrays_are_never_used(tmp_path):
    file = files.write_arrays(tmp_path / "a.npz", ARRAYS)
    whole = file.read_bytes()
    for name, array in files.load_arrays(file).items():
        np.testing.assert_array_equal(array, ARRAYS[name])
    rng = np.random.default_rng(4)
    for _ in range(400):
        bad = damaged(whole, rng)
        file.write_bytes(bad)
        assert bad == whole or files.load_arrays(file) is None
    file.write_bytes(whole[:-78])  # an archive of an older version, without a checksum
    assert files.load_arrays(file) is None
    assert set(np.load(tmp_path / files.write_arrays(tmp_path / "b.npz", ARRAYS, seal=False)).files) == set(ARRAYS)


def tree():
    values = np.random.default_rng(1).normal(size=(40, 30))
    variable = netcdf.Variable(dims=("row", "column"), values=values, unit="m")
    return netcdf.Group(variables={"heights": variable}, attributes={"kind": "test"})


def test_damaged_netcdf_files_of_our_own_are_refused_before_hdf5(tmp_path, monkeypatch):
    path = netcdf.write(tmp_path / "a.nc", tree())
    whole = path.read_bytes()
    np.testing.assert_array_equal(netcdf.read(path).variables["heights"].values, tree().variables["heights"].values)
    with h5netcdf.File(path, "r") as file:  # other programs read it as it is
        assert file.variables["heights"].shape == (40, 30)
    apart = []
    monkeypatch.setattr(netcdf, "_read_apart", lambda path: apart.append(path))
    rng = np.random.default_rng(2)
    for _ in range(200):
        bad = damaged(whole, rng)
        if bad == whole:
            continue
        path.write_bytes(bad)
        before = len(apart)
        if files.is_sealed(path) is None:  # its checksum itself is gone: a process of its own reads it
            netcdf.read(path)
            assert len(apart) == before + 1
        else:
            with pytest.raises(faying.ReadError, match="its checksum does not fit"):
                netcdf.read(path)


def test_foreign_netcdf_files_are_read_by_a_process_of_their_own(tmp_path, monkeypatch):
    path = netcdf.write(tmp_path / "a.nc", tree())
    path.write_bytes(path.read_bytes()[:-78])
    found = netcdf.read(path)
    np.testing.assert_array_equal(found.variables["heights"].values, tree().variables["heights"].values)
    path.write_bytes(b"\x89HDF\r\n\x1a\n" + bytes(500))
    with pytest.raises(faying.ReadError, match="not a NetCDF-4 file, or is damaged"):
        netcdf.read(path)
    monkeypatch.setattr(netcdf, "seconds_for", lambda size: 0.05)
    with pytest.raises(faying.ReadError, match="HDF5 dies on it or does not return .no end within 0 s"):
        netcdf.read(path)


def test_a_result_whose_triangles_name_no_nodes_is_refused(tmp_path):
    from tests.helpers.results import small_result

    result = small_result()
    strays = result.triangles.copy()
    strays[0, 0] = 2**37
    object.__setattr__(result, "triangles", strays)
    path = netcdf.write(tmp_path / "result.nc", result.tree())
    with pytest.raises(faying.ReadError, match="its triangles run from . to 137438953472"):
        type(result).load(path)


@pytest.mark.parametrize("name", ["laws", "surfaces"])
def test_a_result_that_has_lost_the_laws_of_its_joints_is_refused(tmp_path, name):
    from tests.helpers.results import small_result

    tree = small_result().tree()
    del tree.attributes[name]
    path = netcdf.write(tmp_path / "result.nc", tree)
    with pytest.raises(faying.ReadError, match=rf"it has 0 {name} for \d joints"):
        faying.load(path)


def test_json_never_holds_what_it_does_not_know():
    tree = {"a": [1.0, float("nan"), np.float64("inf")], "b": ("x", {"c": -np.inf}), "d": None, "e": 3}
    assert json.loads(json_text(tree)) == {"a": [1.0, None, None], "b": ["x", {"c": None}], "d": None, "e": 3}


def test_a_law_on_a_smooth_scan_is_json(tmp_path, capsys):
    """A sine has no fractal part, so that the height that its fit implies is not known."""
    path = tmp_path / "scan.csv"
    x, y = np.meshgrid(np.arange(64.0), np.arange(64.0))
    np.savetxt(path, np.column_stack([x.ravel(), y.ravel(), np.sin(np.pi * x.ravel() / 8)]), delimiter=",")
    given = ["--xy-unit", "um", "--z-unit", "um", "--material", "45 steel", "--model", "gw-ke", "--json"]
    with pytest.raises(SystemExit) as stop:
        main(["law", "--scan", str(path), *given])
    assert stop.value.code == 0
    out = capsys.readouterr().out
    assert json.loads(out)["law"]
    assert "null" in out


def test_numbers_of_sobol_are_loaded_while_signals_wait(monkeypatch):
    """A Ctrl-C inside SciPy's loading is swallowed there: its points are all alike then, which must not go on."""
    script = (
        "import signal, os, numpy as np\n"
        "signal.signal(signal.SIGINT, signal.default_int_handler)\n"  # a job in the background ignores it
        "orig = np.lib.npyio.NpzFile.__getitem__\n"
        "def get(self, key):\n"
        "    os.kill(os.getpid(), signal.SIGINT)\n"
        "    return orig(self, key)\n"
        "np.lib.npyio.NpzFile.__getitem__ = get\n"
        "from faying.identify.sampling.points import sobol\n"
        "try:\n"
        "    sobol(4, 64, 0)\n"
        "except KeyboardInterrupt:\n"
        "    print('interrupted')\n"
        "print(len(np.unique(sobol(4, 64, 0), axis=0)))\n"
    )
    environment = os.environ | {"PYTHONPATH": os.pathsep.join(filter(None, sys.path))}
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, env=environment, check=False)
    assert done.stdout.split() == ["interrupted", "64"], done.stderr
    monkeypatch.setattr(points, "load_direction_numbers", lambda: None)
    with pytest.raises(faying.InputError, match="all alike: SciPy was interrupted"):
        points.refuse_alike(np.full((8, 3), 0.5))


def test_shares_that_no_sampling_gives_are_refused():
    from faying.distribution import Distribution
    from faying.identify.shares import shares

    priors = [Distribution.read("0 to 1", ""), Distribution.read("0 to 1", "")]
    calls = []

    def broken(x):  # the third call has the points of both samples mixed
        calls.append(len(x))
        return (100.0 if len(calls) > 2 else 1.0) * (x[:, :1] + x[:, 1:])

    with pytest.raises(faying.InputError, match=r"a share of \d+% of the variance came out"):
        shares(broken, priors, count=64)


# folders


HOLDING = """
import sys, time
from pathlib import Path
from faying import files
with files.together(Path(sys.argv[1]), "give another") as hidden:
    (hidden / "half.nc").write_text("half")
    print("holding", flush=True)
    time.sleep(60)
"""


@contextmanager
def holder(folder, *before):
    """A process that writes to a folder, until it is killed; before: the command that starts it."""
    command = [*before, sys.executable, "-c", HOLDING, str(folder)]
    environment = os.environ | {"PYTHONPATH": os.pathsep.join(filter(None, sys.path))}
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True, env=environment) as process:
        try:
            assert process.stdout.readline() == "holding\n"
            yield process
        finally:
            process.kill()


@pytest.mark.parametrize("there", [True, False])
def test_a_second_process_at_one_folder_is_refused(tmp_path, there):
    """Its refusal names the first. What the first left when it was killed neither bars the next one nor stays."""
    folder = tmp_path / "results"
    if there:
        folder.mkdir()
    with holder(folder) as process:
        words = f"process {process.pid} on {re.escape(socket.gethostname())} writes to .*results already; wait for it"
        for _ in range(2):  # asking does not loosen the hold
            with pytest.raises(faying.InputError, match=words), files.together(folder, "give another"):
                pass
        assert list(tmp_path.rglob("half.nc"))
    with files.together(folder, "give another") as hidden:
        (hidden / "a.txt").write_text("a")
    assert [one.name for one in tmp_path.rglob("*")] == ["results", "a.txt"]


def test_a_process_of_another_container_is_refused_as_well(tmp_path):
    """There the processes have other numbers, which may be those of processes here."""
    container = ["unshare", "--pid", "--fork", "--kill-child", "--mount-proc"]
    if not shutil.which("unshare") or subprocess.run([*container, "true"], capture_output=True, check=False).returncode:
        pytest.skip("no name space of processes can be made here")
    folder, words = tmp_path / "results", "writes to .*results already"
    with holder(folder, *container):
        with pytest.raises(faying.InputError, match=words), files.together(folder, "give another"):
            pass
        assert list(tmp_path.rglob("half.nc"))


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="the system has no pipes with names")
def test_outputs_that_are_not_plain_files_stay_what_they_are(tmp_path):
    target, link = tmp_path / "file.csv", tmp_path / "link.csv"
    target.write_text("old")
    link.symlink_to(target)
    files.write_text(link, "new")
    assert link.is_symlink()
    assert target.read_text() == "new"
    files.write_text(Path("/dev/null"), "nothing")
    assert Path("/dev/null").is_char_device()
    pipe = tmp_path / "pipe"
    os.mkfifo(pipe)
    with subprocess.Popen(["cat", str(pipe)], stdout=subprocess.PIPE, text=True) as reader:
        files.write_text(pipe, "through")
        assert reader.communicate(timeout=10)[0] == "through"
    with subprocess.Popen(["cat", str(pipe)], stdout=subprocess.PIPE, text=True) as reader:
        with files.together(tmp_path, "give another") as hidden:
            (hidden / "pipe").write_text("with others")
            (hidden / "link.csv").write_text("newer")
        assert reader.communicate(timeout=10)[0] == "with others"
    assert link.is_symlink()
    assert target.read_text() == "newer"
    assert pipe.is_fifo()
    assert sorted(one.name for one in tmp_path.iterdir()) == ["file.csv", "link.csv", "pipe"]


def test_a_folder_that_appears_meanwhile_takes_the_files_in(tmp_path):
    folder = tmp_path / "results"
    with files.together(folder, "give another") as hidden:
        (hidden / "a.txt").write_text("mine")
        folder.mkdir()
        (folder / "b.txt").write_text("another's")
    assert {one.name: one.read_text() for one in folder.iterdir()} == {"a.txt": "mine", "b.txt": "another's"}


def test_what_was_solved_stays_where_the_rest_does_not_fit(tmp_path):
    folder = tmp_path / "results"

    def write():
        with files.together(folder, "give another", ["result.nc", "other.nc"]) as hidden:
            (hidden / "result.nc").write_text("solved")
            (hidden / "half.html").write_text("<")
            raise faying.InputError(f"cannot write {hidden / 'report.html'}: No space left on device")

    with pytest.raises(faying.InputError, match=r"No space left on device; result.nc was written"):
        write()
    assert [one.name for one in folder.iterdir()] == ["result.nc"]


@pytest.mark.parametrize("number", files.STOPS)
@pytest.mark.parametrize("at", ["gethostname", "rmtree"])
def test_a_stop_while_the_hidden_folder_is_made_or_removed(tmp_path, monkeypatch, number, at):
    """It comes once the folder is as it should be, so that none is left."""
    owner = socket if at == "gethostname" else shutil  # which the lock is written with, and the folder removed
    call = getattr(owner, at)

    def stopped(*args, **given):
        signal.raise_signal(number)
        return call(*args, **given)

    def stop(*_):
        raise KeyboardInterrupt

    before = signal.signal(number, stop)
    try:
        monkeypatch.setattr(owner, at, stopped)
        with pytest.raises(KeyboardInterrupt), files.together(tmp_path / "results", "give another"):
            pass
    finally:
        signal.signal(number, before)
    assert list(tmp_path.iterdir()) == []


def test_a_disk_that_is_full_when_the_hidden_folder_is_made(tmp_path, monkeypatch):
    """Nothing is left of it; what long work has kept in a folder stays there."""

    def full():
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr(socket, "gethostname", full)
    words = "cannot write in .*No space left on device; give another"
    with pytest.raises(faying.InputError, match=words), files.together(tmp_path / "results", "give another"):
        pass
    assert list(tmp_path.iterdir()) == []
    (tmp_path / "done.npz").write_text("an hour's work")
    with pytest.raises(faying.InputError, match=words):
        files.locked(tmp_path, tmp_path, "give another")
    assert [one.name for one in tmp_path.iterdir()] == ["done.npz"]


def test_a_link_that_leads_nowhere(tmp_path):
    (tmp_path / "results").symlink_to(tmp_path / "gone")
    words = "is a link that leads nowhere; remove it"
    with pytest.raises(faying.InputError, match=words), files.together(tmp_path / "results", "give another"):
        pass


def test_a_moved_project_goes_on(tmp_path):
    from faying.study import Study

    prints = []
    for name in ("here", "there"):
        folder = tmp_path / name
        folder.mkdir()
        for file in ("study.toml", "model.inp"):
            (folder / file).write_bytes((BLOCKS / file).read_bytes())
        prints.append(part_folder.fingerprint(Study.read(folder / "study.toml"), 3))
    assert prints[0] == prints[1]


@pytest.mark.parametrize("hidden", [["fcntl"], ["fcntl", "msvcrt"]])
def test_locks_without_the_modules_of_one_system(tmp_path, monkeypatch, hidden):
    for name in hidden:
        monkeypatch.setitem(sys.modules, name, None)
    files.locked(tmp_path, tmp_path, "give another").close()


# the command


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="the system has no /dev/full")
def test_an_output_that_is_full(tmp_path):
    environment = os.environ | {"PYTHONPATH": os.pathsep.join(filter(None, sys.path))}
    with open("/dev/full", "w") as full:
        done = subprocess.run(
            [sys.executable, "-m", "faying", "models"],
            stdout=full,
            stderr=subprocess.PIPE,
            env=environment,
            check=False,
        )
    assert done.returncode == 1
    assert done.stderr.decode() == "faying: cannot write the output: No space left on device\n"


@pytest.mark.skipif(not hasattr(signal, "SIGHUP"), reason="the system has no SIGHUP")
def test_a_terminal_that_is_closed_stops_a_command_tidily(tmp_path):
    environment = os.environ | {"PYTHONPATH": os.pathsep.join(filter(None, sys.path)), "FAYING_CACHE": "off"}
    for file in ("study.toml", "model.inp"):
        (tmp_path / file).write_bytes((BLOCKS / file).read_bytes())
    run = [sys.executable, "-m", "faying", "run", str(tmp_path / "study.toml")]
    process = subprocess.Popen(run, stdout=subprocess.PIPE, stderr=subprocess.PIPE, env=environment)
    deadline = time.monotonic() + 60
    while not any(one.name.endswith(".part") for one in tmp_path.iterdir()) and time.monotonic() < deadline:
        time.sleep(0.01)
    process.send_signal(signal.SIGHUP)
    _, err = process.communicate(timeout=60)
    # CPython ends itself by SIGINT where the interrupt met a text that is executed, as when a dataclass is imported
    assert process.returncode in (0, 1, -signal.SIGINT)
    assert process.returncode == 0 or b"faying: interrupted" in err
    assert b"Traceback" not in err
    assert not [one.name for one in tmp_path.iterdir() if one.name.endswith(".part")]


def test_the_folder_that_one_stands_in(tmp_path, monkeypatch):
    """Given as "." it has no name of its own."""
    monkeypatch.chdir(tmp_path)
    with files.together(Path("."), "give another") as hidden:
        (hidden / "a.txt").write_text("a")
    assert [one.name for one in tmp_path.iterdir()] == ["a.txt"]
