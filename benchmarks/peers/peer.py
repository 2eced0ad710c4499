"""Other codes: where they are, and how one of them is asked in a process of its own."""

import json
import os
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

WITNESSES = Path(__file__).with_name("witness")
VARIABLE = "FAYING_PEERS"  # of the environment: the interpreter that has the packages
ALONE = dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"), "1") | {
    "XLA_FLAGS": "--xla_cpu_multi_thread_eigen=false intra_op_parallelism_threads=1",
    "JAX_ENABLE_X64": "1",
}
VERSIONS = """
import json, sys
from importlib import import_module, metadata, util
found = {}
for module, package in json.load(sys.stdin):
    try:
        there = util.find_spec(module) is not None
    except ImportError:
        there = False
    if there:
        try:
            found[module] = metadata.version(package)
        except metadata.PackageNotFoundError:
            found[module] = ""
print(json.dumps(found))
"""


@dataclass(frozen=True, kw_only=True)
class Peer:
    """A code to compare with: what it is called, its licence, and how to get it.

    module: of Python, that its interpreter imports; program: that the shell finds; neither: numbers that are printed.
    """

    name: str
    licence: str
    get: str
    module: str = ""
    package: str = ""
    program: str = ""


PEERS = {
    peer.name: peer
    for peer in (
        Peer(name="Tamaas", licence="AGPL-3.0", get="pip install tamaas", module="tamaas", package="tamaas"),
        Peer(
            name="ContactMechanics",
            licence="MIT",
            get="pip install ContactMechanics",
            module="ContactMechanics",
            package="ContactMechanics",
        ),
        Peer(
            name="SurfaceTopography",
            licence="MIT",
            get="pip install SurfaceTopography",
            module="SurfaceTopography",
            package="SurfaceTopography",
        ),
        Peer(name="surfalize", licence="GPL-3.0", get="pip install surfalize", module="surfalize", package="surfalize"),
        Peer(name="pyuff", licence="MIT", get="pip install pyuff", module="pyuff", package="pyuff"),
        Peer(name="pyFlange", licence="GPL-3.0", get="pip install pyFlange", module="pyflange", package="pyFlange"),
        Peer(name="FLife", licence="MIT", get="pip install FLife", module="FLife", package="FLife"),
        Peer(
            name="tmdsimpy",
            licence="MIT",
            get='github.com/tmd-lab/tmdsimpy on PYTHONPATH, and pip install "jax[cpu]"',
            module="tmdsimpy",
            package="tmdsimpy",
        ),
        Peer(name="CalculiX", licence="GPL-2.0", get="the program ccx on PATH", program="ccx"),
        Peer(name="NAFEMS", licence="", get=""),
    )
}


def interpreter(python: str | None = None) -> str:
    """The interpreter that has the packages: the one given, that of the environment, or this one."""
    return python or os.environ.get(VARIABLE) or sys.executable


def present(python: str) -> dict[str, str]:
    """Version of each peer that is there, by name."""
    asked = [(peer.module, peer.package) for peer in PEERS.values() if peer.module]
    done = subprocess.run(
        [python, "-c", VERSIONS], input=json.dumps(asked), capture_output=True, text=True, check=True, cwd=WITNESSES
    )
    modules = json.loads(done.stdout)
    found = {peer.name: modules[peer.module] for peer in PEERS.values() if peer.module in modules}
    for peer in PEERS.values():
        if peer.program and shutil.which(peer.program):
            printed = subprocess.run([peer.program, "-v"], capture_output=True, text=True, check=False).stdout.split()
            found[peer.name] = printed[-1] if printed else ""
        if not peer.program and not peer.module:
            found[peer.name] = ""
    return found


def ask(
    python: str,
    witness: str,
    *words: str,
    before: tuple[str, ...] = (),
    path: Path | None = None,
    **arrays: Any,
) -> Mapping[str, Any]:
    """Run a witness on named arrays in the peer's interpreter and return the arrays that it gives.

    words: of its command line, before the names of the files; before: in front of the command; path: put on
    PYTHONPATH. A witness that fails raises RuntimeError with the last line that it printed.
    """
    environment = os.environ | ALONE | ({"PYTHONPATH": str(path)} if path else {})
    with tempfile.TemporaryDirectory() as folder:
        given, found = Path(folder) / "in.npz", Path(folder) / "out.npz"
        np.savez(given, **arrays)
        command = [*before, python, str(WITNESSES / witness), *words, str(given), str(found)]
        done = subprocess.run(command, capture_output=True, text=True, env=environment, check=False)
        if done.returncode:
            raise RuntimeError((done.stderr.strip().splitlines() or ["it printed nothing"])[-1][:200])
        with np.load(found) as out:
            return dict(out)
