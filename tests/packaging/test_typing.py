"""Type checkers and editors see every public name, with its types: a user's script passes mypy --strict."""

import ast
import subprocess
import sys
from pathlib import Path

import pytest

import faying

pytest.importorskip("mypy", reason="the check needs the group dev")

GOOD = '''"""What a notebook begins with."""

import faying

scan = faying.read_scan("milled.x3p")
faces = faying.Mates(scan, materials="45 steel")
print(faces)
law = faces.law()
print(law.at_pressure("5 MPa").k_n, law.at_pressure(5e6).k_load)
jk = faces.law("jk", alpha=0.3)
table = faces.compare()
print(table.sel(pressure=5e6, method="nearest").k_n.to_series())
axes = faces.compare_plot(laws=["jk", "persson"])
axes.set_title("my scan")
given = faying.Mates.of_fractal(D=2.39, G="0.153 nm", scan_area="16 mm^2", materials=("45 steel", "rigid"))
pair = faying.ContactPair("45 steel", faying.CATALOGUE["S355"])
smooth = faying.Mates(scan, materials=pair, other="smooth").law("gw-ke")
result = faying.run("study.toml")
print(result.frequencies, given.line, smooth.name)
'''
# each line is a fault that a checker can find, because the names are not Any
BAD = """import faying
faying.Mates(3, materials="45 steel")
faying.Mates.of_fractal(D=2.4, G=1e-10, scan_area=1e-6, materials=7)
faying.ContactPair("45 steel", 7)
faying.JK(D=2.4, G=1e-10, scan_area=1e-6, pair="45 steel")
faying.no_such_name
faying.run("study.toml").no_such_field
"""


@pytest.mark.slow
def test_a_users_script_passes_and_its_faults_are_found(tmp_path: Path) -> None:
    good, bad = tmp_path / "good.py", tmp_path / "bad.py"
    good.write_text(GOOD)
    bad.write_text(BAD)
    words = ["--strict", "--config-file=", "--no-error-summary", f"--cache-dir={tmp_path / 'cache'}"]
    done = subprocess.run(
        [sys.executable, "-m", "mypy", *words, str(good), str(bad)],
        capture_output=True,
        text=True,
        check=False,
        cwd=tmp_path,
    )
    found = [line for line in done.stdout.splitlines() if ": error:" in line]
    assert not [line for line in found if Path(line.split(":")[0]).name != "bad.py"], done.stdout
    assert sorted({int(line.split(":")[1]) for line in found}) == list(range(2, 1 + BAD.count("\n"))), done.stdout


def test_the_stub_exports_every_public_name() -> None:
    """A name in a stub is exported where it is imported as itself (PEP 484)."""
    stub = Path(faying.__file__).with_suffix(".pyi")
    names = [
        alias for node in ast.parse(stub.read_text()).body if isinstance(node, ast.ImportFrom) for alias in node.names
    ]
    assert [alias.name for alias in names if alias.asname != alias.name] == []
    assert sorted(alias.name for alias in names) == sorted(faying.__all__)
