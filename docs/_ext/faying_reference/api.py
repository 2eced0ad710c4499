"""The public names, each by autodoc, in the groups of the page."""

import builtins
import importlib
import inspect
import re
from collections.abc import Mapping
from typing import Any

from docutils import nodes
from sphinx.addnodes import pending_xref
from sphinx.application import Sphinx
from sphinx.environment import BuildEnvironment
from sphinx.util.docutils import SphinxDirective

import faying
import faying.contact
from faying_reference.rst import heading

# title -> names; a public name that stands in none comes under the last
GROUPS: Mapping[str, tuple[str, ...]] = {
    "Studies": ("Study", "run", "sweep", "axis_of", "backbone", "attach", "load_cases"),
    "Results": (
        "Result",
        "load",
        "view",
        "LoadCases",
        "Backbone",
        "MeasuredBackbone",
        "ring_down",
        "ring_down_of_frf",
        "read_model_modes",
    ),
    "Surfaces": (
        *("read_scan", "write_scan", "Scan", "Profile", "synthesize", "fit_fractal", "FractalFit", "combine"),
        *("Combined", "Roughness"),
    ),
    "Contact": (
        *("Mates", "JK", "HalfSpace", "solve_half_space", "contact"),
        *("ContactLaw", "Response", "Comparison"),
    ),
    "Materials": ("Material", "ContactPair", "CATALOGUE", "RIGID"),
    "Structures": (
        *("Structure", "State", "VibrationModes", "Joint", "Bolt", "Washer", "SolidBolt", "Dowel"),
        *("Support", "PointMass"),
        *("Load", "Force", "Pressure", "Displacement"),
        *("Mesh", "read_mesh", "read_matrices", "Form", "Waviness", "GapMap", "FaceMap", "fit_form", "minimum_zone"),
    ),
    "Tests": (*("FRF", "identify_modes", "read_uff", "write_uff", "ModelModes", "compare_modes"),),
    "Errors": ("FayingError", "InputError", "ReadError", "NotConverged"),
    "Others": (),
}

# where names of annotations without a module are looked for: those of overloads stand as they are written
BARE = ("typing", "numpy", "pathlib", "matplotlib.axes", "pandas", "xarray", "faying.backbones.backbone")

DATA = {
    "faying.CATALOGUE": "The materials that need not be given, by name: :ref:`catalogue`.",
    "faying.RIGID": "The material of a body that does not yield.",
}


def grouped() -> dict[str, list[str]]:
    """Every public name by its group."""
    named = {name for names in GROUPS.values() for name in names}
    missing = sorted(named - set(faying.__all__))
    if missing:
        raise RuntimeError(f"the reference groups names that are not public: {', '.join(missing)}")
    rest = [name for name in faying.__all__ if name not in named]
    last = list(GROUPS)[-1]
    return {title: [*names, *(rest if title == last else ())] for title, names in GROUPS.items()}


def _entry(path: str, value: Any) -> list[str]:
    if inspect.ismodule(value):
        return [f"``{path}``: :doc:`contact`.", ""]
    if inspect.isclass(value):
        bases = [base for base in value.__bases__ if base is not object]
        return [f".. autoclass:: {path}", "   :members:", *(["   :show-inheritance:"] if bases else []), ""]
    if callable(value):
        return [f".. autofunction:: {path}", ""]
    return [f".. py:data:: {path}", "", f"   {DATA[path]}", ""]


class PublicNames(SphinxDirective):
    """Document every public name of `faying`."""

    def run(self) -> list[nodes.Node]:
        """Return the sections."""
        lines: list[str] = []
        for title, names in grouped().items():
            if names:
                lines += heading(title)
                for name in names:
                    lines += _entry(f"faying.{name}", getattr(faying, name))
        return self.parse_text_to_nodes("\n".join(lines), allow_section_headings=True)


class ContactNames(SphinxDirective):
    """Document every public name of `faying.contact` and of its `asperity`."""

    def run(self) -> list[nodes.Node]:
        """Return the sections."""
        asperity = faying.contact.asperity
        lines: list[str] = []
        for title, module in (("Surfaces of many asperities", faying.contact), ("Single asperities", asperity)):
            lines += heading(title)
            for name in sorted(module.__all__, key=str.lower):
                value = getattr(module, name)
                public = getattr(faying, name, None) is value
                if not inspect.ismodule(value) and not public:
                    lines += _entry(f"{module.__name__}.{name}", value)
        return self.parse_text_to_nodes("\n".join(lines), allow_section_headings=True)


def signature(
    _app: Sphinx, _what: str, _name: str, _obj: Any, _options: Any, given: str | None, back: str | None
) -> tuple[str | None, str | None] | None:
    """Write a default that a dataclass makes anew as an ellipsis, which Sphinx can read."""
    return (given.replace("<factory>", "..."), back) if given and "<factory>" in given else None


def _homes() -> dict[str, str]:
    """Where a class or function that is defined elsewhere is documented."""
    homes: dict[str, str] = {}
    for module in (faying.contact.asperity, faying.contact, faying):
        for name in module.__all__:
            value = getattr(module, name)
            if inspect.isclass(value) or inspect.isfunction(value):
                homes[f"{value.__module__}.{value.__qualname__}"] = f"{module.__name__}.{name}"
    return homes


def _exists(path: str) -> bool:
    """Whether a dotted name is something that can be imported."""
    parts = re.sub(r"\[.*", "", path).split(".")
    if len(parts) == 1:
        return hasattr(builtins, path) or any(hasattr(importlib.import_module(m), path) for m in BARE)
    for size in range(len(parts) - 1, 0, -1):
        try:
            value: Any = importlib.import_module(".".join(parts[:size]))
        except ImportError:
            continue
        try:
            for part in parts[size:]:
                value = getattr(value, part)
        except AttributeError:
            return part in getattr(value, "__annotations__", {})
        return True
    return False


def resolve(app: Sphinx, env: BuildEnvironment, node: pending_xref, content: nodes.Element) -> Any:
    """Link a name to where it is public; leave one of another package, or of the inside, as plain text."""
    if node.get("refdomain") != "py":
        return None
    target = str(node["reftarget"])
    home = _homes().get(target)
    if home is not None and home != target:
        kind = "class" if inspect.isclass(eval_name(home)) else "func"
        found = env.domains["py"].resolve_xref(env, node["refdoc"], app.builder, kind, home, node, content)
        if found is not None:
            return found
    return content if _exists(target) else None


def eval_name(path: str) -> Any:
    """What a dotted public name stands for."""
    module, _, name = path.rpartition(".")
    return getattr(importlib.import_module(module), name)
