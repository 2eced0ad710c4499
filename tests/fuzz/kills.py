"""Commands killed at random times: what was there before stays, no worker outlives them, what is written is whole."""

import os
import random
import shutil
import signal
import subprocess
import sys
import time
from dataclasses import dataclass
from pathlib import Path

import faying
from faying import netcdf

ROOT = Path(__file__).parents[2]
BLOCKS = ROOT / "examples" / "two-blocks"
SIGNALS = (signal.SIGKILL, signal.SIGTERM, signal.SIGHUP)
COMMANDS = {
    "run": ["run", "uncertain.toml"],
    "predict": ["predict", "uncertain.toml", "--samples", "64", "--jobs", "2"],
    "sweep": ["sweep", "uncertain.toml", "--set", "surface.D=2.2:2.6:6", "--set", "law.model=jk,gw", "--jobs", "2"],
    "identify": ["identify", "uncertain.toml", "--jobs", "2"],
    "backbone": ["backbone", "uncertain.toml"],
    "law": ["law", "--scan", "scan.x3p", "--material", "45 steel", "--json"],
    "new": ["new", "deck.inp", "--unit", "mm", "--yes", "--force", "--out", "new.toml"],
}
FREE = 2.0  # s after the end of a command by which its workers must have ended


@dataclass(frozen=True, kw_only=True)
class Kill:
    """One killed command: when, with what, its exit code, and what is wrong; "" where nothing is."""

    command: str
    after: float
    signal: str
    code: int
    fault: str


def environment():
    paths = os.pathsep.join([str(ROOT / "src"), str(ROOT)])
    return os.environ | {"PYTHONPATH": paths, "OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}


def start(words, folder):
    """The command in a session of its own, so that its workers can be told from others."""
    log = (folder / "log.txt").open("ab")
    with log:
        return subprocess.Popen(
            [sys.executable, "-m", "faying", *words],
            cwd=folder,
            env=environment(),
            stdout=log,
            stderr=log,
            stdin=subprocess.DEVNULL,
            start_new_session=True,
        )


def of_session(number):
    """The processes of a session that still run."""
    found = []
    for entry in Path("/proc").iterdir():
        if not entry.name.isdigit():
            continue
        try:
            words = (entry / "stat").read_text().rpartition(")")[2].split()
        except OSError:
            continue
        if int(words[3]) == number and words[0] not in "ZX":
            found.append(int(entry.name))
    return found


def prepared(folder):
    """A folder with the study, a deck and a scan, and what each of them gives in peace."""
    shutil.copytree(BLOCKS, folder, dirs_exist_ok=True)
    shutil.rmtree(folder / "results", ignore_errors=True)
    shutil.copy(folder / "model.inp", folder / "deck.inp")
    faying.write_scan(
        faying.surface.synthesize.spectral((64, 64), spacing=2e-6, D=2.3, Rq=5e-7, seed=1), folder / "scan.x3p"
    )
    return folder


def files(folder):
    """The content of every result that stands, by its name."""
    return {
        str(path.relative_to(folder)): path.read_bytes()
        for path in sorted(folder.rglob("*"))
        if path.is_file() and not any(part.startswith(".") for part in path.relative_to(folder).parts)
        if path.name != "log.txt" and not any(part.endswith(".part") for part in path.parts)  # work in progress
    }


def unreadable(folder):
    """The first result that cannot be read."""
    for path in sorted(folder.rglob("*.nc")):
        if any(part.startswith(".") for part in path.relative_to(folder).parts) or ".part" in str(path):
            continue
        try:
            netcdf.read(path) if path.name == "sweep.nc" else faying.load(path)
        except faying.FayingError as fault:
            return f"{path.name}: {fault}"
    return ""


def killed(command, folder, after, number):
    """Start a command, kill it after some seconds, and look at what is left."""
    before = files(folder)
    process = start(COMMANDS[command], folder)
    time.sleep(after)
    process.send_signal(number)
    try:
        code = process.wait(20)
    except subprocess.TimeoutExpired:
        process.kill()
        return Kill(command=command, after=after, signal=number.name, code=-1, fault="it goes on after the signal")
    end = time.monotonic() + FREE
    while of_session(process.pid) and time.monotonic() < end:
        time.sleep(0.05)
    alive = of_session(process.pid)
    for one in alive:
        os.kill(one, signal.SIGKILL)
    now = files(folder)
    lost = sorted(name for name in before if name not in now)
    fault = f"{len(alive)} workers live" if alive else f"{lost[0]} is gone" if lost else unreadable(folder)
    if not fault and code == 0 and command not in ("law", "new") and not any(n.endswith(".nc") for n in now):
        fault = "it says that all is well and wrote nothing"
    return Kill(command=command, after=after, signal=number.name, code=code, fault=fault)


def whole(command, folder):
    """What a command says when nobody kills it, "" where it comes to its end."""
    process = start(COMMANDS[command], folder)
    code = process.wait(300)
    return "" if code == 0 else f"{command} exits with {code}: {(folder / 'log.txt').read_text()[-300:]}"


def twice(command, folder):
    """Two of a command at once: both end well, or one refuses in words; nothing is lost."""
    two = [start(COMMANDS[command], folder) for _ in range(2)]
    codes = [process.wait(300) for process in two]
    text = (folder / "log.txt").read_text()
    fault = "" if 0 in codes and "Traceback" not in text else f"{command} twice: exit codes {codes}: {text[-300:]}"
    return fault or unreadable(folder)


def campaign(folder, count, seed, commands=tuple(COMMANDS)):
    """`count` kills over some commands; yields every Kill, and every fault of what follows as text."""
    rng = random.Random(seed)
    prepared(folder)
    seconds = {}
    for command in commands:
        begun = time.monotonic()
        if fault := whole(command, folder):
            yield fault
        seconds[command] = time.monotonic() - begun
    for number in range(count):
        command = commands[number % len(commands)]
        if number % 2 and (folder / "results").exists() and command not in ("identify", "backbone"):
            for path in folder.rglob("*.nc"):  # work from the beginning
                path.unlink()
            whole("run", folder)
        yield killed(command, folder, rng.uniform(0.05, 1.05) * seconds[command], SIGNALS[number % 3])
    for command in commands:
        if fault := whole(command, folder):
            yield fault
    for command in commands:
        if fault := twice(command, folder):
            yield fault
    left = [str(path) for path in folder.rglob("*") if ".part" in path.name or path.name.startswith(".tmp")]
    if left:
        yield f"left behind: {', '.join(left)}"


def main():
    """python -m tests.fuzz.kills FOLDER COUNT SEED [COMMAND ...]: print every kill and what is wrong."""
    folder, count, seed = Path(sys.argv[1]), int(sys.argv[2]), int(sys.argv[3])
    for one in campaign(folder, count, seed, tuple(sys.argv[4:]) or tuple(COMMANDS)):
        print(one, flush=True)


if __name__ == "__main__":
    main()
