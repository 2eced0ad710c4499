"""The group of commands. A command's module is imported only when the command is called for."""

import errno
import os
import signal
import sys
import threading
from contextlib import suppress
from importlib import import_module
from typing import Any

import click

# command -> (module, one line for `faying --help`)
COMMANDS = {
    "app": ("app", "Open a page in the browser: scan, geometry, study, run, result."),
    "attach": ("attach", "Add a joint to a model of another solver, in the format of that solver."),
    "backbone": ("backbone", "Frequency and damping of a mode against its amplitude."),
    "bolts": ("bolts", "A sheet for each bolt by VDI 2230: preload, stresses, slip, torque."),
    "check": ("check", "Check a study without solving it: faults, notes, memory, time."),
    "compare": ("measured.compare", "Compare a hammer test with the result of a study: MAC, pairs, FRFs."),
    "condense": ("condense", "One joint as a 6 x 6 stiffness, or the structure as a superelement, with the error."),
    "doctor": ("doctor", "What works on this machine, and what to do about the rest."),
    "faces": ("faces", "Faces of a STEP or mesh file: numbers, normals, centres, contacts."),
    "form": ("scan.form", "Flatness, crowns and twist of a measured face or gap."),
    "identify": ("measured.identify", "Update the uncertain numbers of a study from a hammer test."),
    "init": ("init", "Write a commented study file to start from."),
    "law": ("scan.law", "Curves of a contact law: area, stiffness and loss against pressure."),
    "loads": ("loads", "Bolt forces, opening and slip under load cases about the preload."),
    "models": ("scan.models", "List the contact models with their sources, inputs and ranges."),
    "modes": ("modes", "Real modes of a study or of assembled matrices."),
    "new": ("new", "Write a study of your own STEP file: joints, bolts, seats, mesh."),
    "predict": ("measured.predict", "Intervals of the frequencies from uncertain inputs, and which input causes them."),
    "ring-down": ("measured.ring_down", "Frequency and damping over amplitude from a free decay."),
    "run": ("run", "Run a study: from the surface and the preload to the modes."),
    "schema": ("schema", "JSON schema of a study, for editors that know TOML."),
    "sweep": ("sweep", "Many laws, surfaces and preloads on one structure, solved once."),
    "surface": ("scan.surface", "Roughness, fractal dimension D and roughness G of a scan."),
    "test": ("measured.test", "Identify the modes of a hammer test from its FRFs."),
    "vibration": ("vibration", "Random vibration and sine sweeps: levels, damping, bolts, margins of slip."),
    "view": ("view", "Show a study, a result, a mesh or a STEP file in the browser."),
}


class _Commands(click.Group):
    """Lists the commands from COMMANDS without importing them."""

    def list_commands(self, ctx: click.Context) -> list[str]:
        return list(COMMANDS)

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:
        if cmd_name not in COMMANDS:
            return None
        command: click.Command = import_module(f"faying.cli.{COMMANDS[cmd_name][0]}").command
        return command

    def format_commands(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        with formatter.section("Commands"):
            formatter.write_dl([(name, text) for name, (_, text) in COMMANDS.items()])


@click.group(cls=_Commands, context_settings={"help_option_names": ["-h", "--help"]})
@click.version_option(package_name="faying")
def cli() -> None:
    """From a measured rough surface and a bolt preload to the vibration modes of the bolted structure."""


FULL = (errno.ENOSPC, errno.EIO, errno.EDQUOT, errno.EFBIG)  # the output goes where nothing fits


def _stop(*_: object) -> None:
    raise KeyboardInterrupt


def _open_streams() -> None:
    """Open what a caller has closed of stdin, stdout and stderr: the next file would get its number, and be written."""
    for number, name in enumerate(("stdin", "stdout", "stderr")):
        try:
            os.fstat(number)
        except OSError:
            os.open(os.devnull, os.O_RDWR)  # takes the lowest number that is free
        if getattr(sys, name) is None:
            setattr(sys, name, open(number, "w" if number else "r", closefd=False))  # noqa: SIM115  # until the end


def _share_cores() -> None:
    """Leave the cores to PARDISO, whose threads pay; those of OpenBLAS wait for each other on blocks of few columns.

    Threads that wait do so asleep. What the environment says goes first.
    """
    if "OMP_NUM_THREADS" not in os.environ:
        os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    os.environ.setdefault("KMP_BLOCKTIME", "0")  # ms that a thread of Intel's OpenMP spins after its work


def main(argv: list[str] | None = None) -> None:
    """Entry point of the command `faying`. Exit codes: 0 done, 1 failed or stopped, 2 wrong usage."""
    from faying.errors import FayingError
    from faying.files import STOPS

    _open_streams()
    _share_cores()
    # kill, a batch system's time limit and a closed terminal clear up as Ctrl-C does; nohup ignores the last
    alone = threading.current_thread() is threading.main_thread()
    stops = [one for one in STOPS if alone and signal.getsignal(one) is signal.SIG_DFL]
    for one in stops:
        signal.signal(one, _stop)
    try:
        code: Any = cli.main(args=argv, prog_name="faying", standalone_mode=False)
        sys.stdout.flush()
    except OSError as fault:
        if fault.errno not in FULL:
            raise
        with suppress(OSError, ValueError):  # what cannot be written goes, or the interpreter tries it again at its end
            os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        click.echo(f"faying: cannot write the output: {fault.strerror}", err=True)
        sys.exit(1)
    except FayingError as fault:
        click.echo(f"faying: {fault}", err=True)
        sys.exit(1)
    except click.exceptions.Abort as stop:
        if isinstance(stop.__cause__, EOFError):  # click takes the end of any file for the user's wish
            raise stop.__cause__ from None
        click.echo("faying: interrupted", err=True)
        sys.exit(1)
    except click.ClickException as fault:
        fault.show()
        sys.exit(fault.exit_code)
    finally:
        for one in stops:
            signal.signal(one, signal.SIG_DFL)
    sys.exit(code if isinstance(code, int) else 0)
