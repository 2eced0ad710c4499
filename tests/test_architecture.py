"""The order of imports, no circles, and modules and functions short enough to read."""

import ast
import graphlib
import importlib
import importlib.util
from pathlib import Path

import pytest

ROOT = Path(__file__).parent.parent
SOURCE = ROOT / "src" / "faying"

# a room may import from rooms on earlier lines, and from itself; rooms on one line do not see each other
ORDER = [
    {"errors"},
    {"units", "files", "memory", "typing", "notes", "progress", "apart"},
    {"checks", "file_kinds"},
    {"hardness", "misuse", "text", "data_sets", "typeset"},
    {"materials", "netcdf", "columns", "distribution", "cache", "style"},
    {"numerics", "surface"},
    {"fe", "halfspace"},
    {"geometry", "bolt", "contact"},
    {"form"},
    {"joint"},
    {"microslip", "reduction", "measured", "decks"},
    {"result"},
    {"study"},
    {"case"},
    {"backbones", "sweeps", "export", "setup", "service"},
    {"answer"},
    {"identify"},
    {"output"},
    {"loads"},
    {"sheet"},
    {"saved"},
    {"app"},
    {"cli"},
    {"__main__"},
]
RANK = {room: rank for rank, rooms in enumerate(ORDER) for room in rooms}
MODULES = sorted(SOURCE.rglob("*.py"))


@pytest.fixture(scope="module")
def nodes():
    """The nodes of the syntax tree of each module, breadth first."""
    return {path: list(ast.walk(ast.parse(path.read_text()))) for path in MODULES}


def imported(nodes):
    for node in nodes:
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


def test_imports_go_downwards_only(nodes):
    faults = []
    for path in MODULES:
        name = path.relative_to(SOURCE)
        here = name.with_suffix("").parts[0]
        if here == "__init__":
            continue
        assert here in RANK, f"{here} is not a room of the house"
        faults += [f"{name} imports {o}" for o in imported(nodes[path]) if o != here and RANK[o] >= RANK[here]]
    assert not faults, "\n".join(faults)


def test_no_module_passes_400_statements(nodes):
    count = {path: sum(isinstance(node, ast.stmt) for node in nodes[path]) for path in MODULES}
    assert {path: number for path, number in count.items() if number > 400} == {}


# functions of more than 8 parameters, each with its reason; none is longer than 60 lines beside its docstring
PUBLIC = "public function of Python users, who name its options"
EXCEPTIONS = {
    "halfspace/solve.py:solve_half_space": PUBLIC,
    "identify/identify.py:identify_model": PUBLIC,
    "bolt/bolt.py:__init__": PUBLIC,
    "joint/joint.py:__init__": PUBLIC,
    "study/load.py:__init__": PUBLIC,
    "study/vibration.py:__init__": PUBLIC,
    "export/attach.py:attach": PUBLIC,
    "backbones/backbone.py:backbone": PUBLIC,
    "surface/synthesize.py:spectral": PUBLIC,
}
LONGEST, MOST_PARAMETERS = 60, 8


def test_functions_are_short_and_take_few_parameters(nodes):
    too_long = {}
    functions = [(path, node) for path in MODULES for node in nodes[path] if isinstance(node, ast.FunctionDef)]
    for path, node in functions:
        is_command = any("click" in ast.unparse(mark) for mark in node.decorator_list)  # one parameter an option
        given = [a for a in (*node.args.args, *node.args.kwonlyargs) if a.arg not in ("self", "cls")]
        documented = ast.get_docstring(node) is not None
        lines = node.end_lineno - (node.body[0].end_lineno if documented else node.lineno - 1)
        if not is_command and (lines > LONGEST or len(given) > MOST_PARAMETERS):
            too_long[f"{path.relative_to(SOURCE)}:{node.name}"] = (lines, len(given))
    assert set(too_long) == set(EXCEPTIONS), too_long


def test_formatting_is_never_switched_off():
    assert not [path.name for path in MODULES if "fmt: skip" in path.read_text() or "fmt: off" in path.read_text()]


def test_no_module_imports_in_a_circle(nodes):
    """Nor within a room, inside functions, or for type checkers alone."""
    names = {
        ".".join(("faying", *p.relative_to(SOURCE).with_suffix("").parts)).removesuffix(".__init__"): p for p in MODULES
    }
    graph = {}
    for name, path in names.items():
        found = graph[name] = set()
        for node in nodes[path]:
            if isinstance(node, ast.ImportFrom) and node.module:
                for alias in node.names:
                    whole = f"{node.module}.{alias.name}"
                    found |= {whole} & set(names) or {node.module} & set(names)
    order = graphlib.TopologicalSorter(graph)
    order.prepare()  # raises CycleError, which names the circle


def test_only_units_imports_pint():
    users = {path.name for path in MODULES if "import pint" in path.read_text()}
    assert users == {"units.py"}


TWICE = {"JK"}  # the law of a fractal surface, and one cap of it, each by its name in the literature


def test_every_class_has_a_name_of_its_own(nodes):
    names = [
        node.name
        for path in MODULES
        for node in nodes[path]
        if isinstance(node, ast.ClassDef) and not node.name.startswith("_")
    ]
    assert {name for name in names if names.count(name) > 1} == TWICE


# words that need their author; each has a word of the field
PRIVATE_WORDS = (
    {"begun", "Beyond", "Corners", "Frame", "grips", "held", "Kept", "led_on", "NearbyModes"}
    | {"past_end", "Recipe", "Seen", "settled", "sprung", "standing", "stay", "told", "upheld"}
    | {"vibrating", "walked", "Witness", "worn"}
)


# a limit says what it limits: MAX_NEWTON_STEPS
VAGUE = {"BEYOND", "BESIDE", "FAR", "FEW", "KEPT", "LEAST", "MANY", "MORE", "MOST", "NEAR", "SEEN", "STILL", "WHOLE"}


def test_every_limit_says_what_it_limits(nodes):
    for path in MODULES:
        for node in nodes[path][0].body:
            targets = node.targets if isinstance(node, ast.Assign) else [getattr(node, "target", None)]
            named = [one for target in targets if target is not None for one in ast.walk(target)]
            names = {one.id for one in named if isinstance(one, ast.Name)}
            assert not names & VAGUE, f"{path}: {names & VAGUE}"


def test_no_name_is_a_word_that_needs_its_author(nodes):
    for path in MODULES:
        for node in nodes[path]:
            if isinstance(node, ast.FunctionDef | ast.ClassDef):
                assert node.name.lstrip("_") not in PRIVATE_WORDS, f"{path}: {node.name}"


def test_what_benchmarks_and_examples_import_is_there():
    for folder in ("benchmarks", "examples", "docs"):
        for path in (ROOT / folder).rglob("*.py"):
            for node in ast.walk(ast.parse(path.read_text())):
                if isinstance(node, ast.ImportFrom) and (node.module or "").split(".")[0] == "faying":
                    module = importlib.import_module(node.module)
                    missing = [one.name for one in node.names if not _has(module, one.name)]
                    assert not missing, f"{path}, line {node.lineno}: {node.module} has no {', '.join(missing)}"


def _has(module, name):
    return hasattr(module, name) or importlib.util.find_spec(f"{module.__name__}.{name}") is not None
