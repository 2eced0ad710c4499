"""The house's import order, and modules short enough to read."""

import ast
from pathlib import Path

import pytest

SOURCE = Path(__file__).parent.parent / "src" / "faying"

# a room may import from rooms on earlier lines, and from itself; rooms on one line do not see each other
ORDER = [
    {"errors"},
    {"units", "files", "memory", "typing", "notes"},
    {"materials", "netcdf"},
    {"surface", "fe", "halfspace"},
    {"contact", "asperity_fe"},
    {"joint"},
    {"measured", "decks"},
    {"result"},
    {"study"},
    {"output"},
    {"cli"},
    {"__main__"},
]
RANK = {room: rank for rank, rooms in enumerate(ORDER) for room in rooms}
MODULES = sorted(SOURCE.rglob("*.py"))


def room(path):
    parts = path.relative_to(SOURCE).with_suffix("").parts
    return parts[0]


def imported(path):
    for node in ast.walk(ast.parse(path.read_text())):
        names = []
        if isinstance(node, ast.Import):
            names = [alias.name for alias in node.names]
        elif isinstance(node, ast.ImportFrom) and node.module:
            names = (
                [f"{node.module}.{alias.name}" for alias in node.names] if node.module == "faying" else [node.module]
            )
        for name in names:
            parts = name.split(".")
            if parts[0] == "faying" and len(parts) > 1 and parts[1] in RANK:
                yield parts[1]


@pytest.mark.parametrize("path", MODULES, ids=lambda p: str(p.relative_to(SOURCE)))
def test_imports_go_downwards_only(path):
    here = room(path)
    if here == "__init__":
        return
    assert here in RANK, f"{here} is not a room of the house"
    for other in imported(path):
        assert other == here or RANK[other] < RANK[here], f"{here} imports {other}"


@pytest.mark.parametrize("path", MODULES, ids=lambda p: str(p.relative_to(SOURCE)))
def test_no_module_passes_400_statements(path):
    assert sum(isinstance(node, ast.stmt) for node in ast.walk(ast.parse(path.read_text()))) <= 400


def test_only_units_imports_pint():
    users = {path.name for path in MODULES if "import pint" in path.read_text()}
    assert users == {"units.py"}
