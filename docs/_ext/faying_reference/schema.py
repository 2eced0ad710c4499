"""The JSON schema of a study, from the keys that the readers ask for: what `faying schema` gives to editors.

Write it anew after a change of keys, from the folder of the repository:

    PYTHONPATH=docs/_ext python -m faying_reference.schema
"""

import json
import re
from pathlib import Path
from typing import Any

from faying_reference.study_keys import NAME, SAME_AS, Key, meanings, recorded

ROOT = Path(__file__).parents[3]
FILE = ROOT / "src" / "faying" / "study" / "schema.json"
KEYS = ROOT / "docs" / "reference" / "keys.toml"

NUMERAL = r"[+-]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]+)?"
SCATTERS = r".*(?: to |\+-|\+/-|±).*"  # a number that scatters: "0.1 to 0.6", "200 GPa +- 4 GPa"
QUANTITY = {"type": "string", "pattern": rf"^\s*{NUMERAL}\s*([^0-9\s.]|1\s*/)"}
NUMBER = {"anyOf": [{"type": "number"}, {"type": "string", "pattern": rf"^\s*{NUMERAL}{SCATTERS}$"}]}
TEXT = {"type": "string"}
WHOLE = {"type": "integer", "minimum": 1, "maximum": 1_000_000}


def listed(item: Any, least: int, most: int | None = None) -> dict[str, Any]:
    """A list of so many items."""
    return {"type": "array", "items": item, "minItems": least} | ({} if most is None else {"maxItems": most})


POINT = listed({"$ref": "#/$defs/quantity"}, 3, 3)
DIRECTION = listed({"type": "number"}, 3, 3)
FACE = {"anyOf": [TEXT, {"$ref": "#/$defs/selector"}]}
ONE_OR_MORE = {"anyOf": [{"$ref": "#/$defs/quantity"}, listed({"$ref": "#/$defs/quantity"}, 1)]}
# what is written under keys whose readers convert it by themselves
OWN: dict[str, dict[str, Any]] = {
    "geometry.face.NAME.normal": {
        "anyOf": [{"enum": ["+x", "-x", "+y", "-y", "+z", "-z"]}, DIRECTION],
    },
    "geometry.face.NAME.number": {"anyOf": [WHOLE, listed(WHOLE, 1)]},
    "geometry.leave_out": listed(TEXT, 0),
    "joint.faces": listed(FACE, 2, 2),
    "bolt.faces": listed(FACE, 2, 2),
    "support.face": FACE,
    "mass.face": FACE,
    "surface.size": QUANTITY,
    "surface.spacing": QUANTITY,
    "bolt.preload": ONE_OR_MORE,
    "modes.levels": listed({"$ref": "#/$defs/quantity"}, 0),
    "bolt.torque": ONE_OR_MORE,
    "bolt.seat": listed({"$ref": "#/$defs/quantity"}, 2, 2),
    "bolt_sheet.load": {"anyOf": [TEXT, listed(TEXT, 1)]},
    "bolt_sheet.axial": {
        "anyOf": [{"$ref": "#/$defs/quantity"}, listed({"$ref": "#/$defs/quantity"}, 2, 2)],
    },
    "bolt_sheet.transverse": {"$ref": "#/$defs/quantity"},
    "bolt_sheet.clamp": {"$ref": "#/$defs/quantity"},
    "bolt_sheet.tightening_factor": {"type": "number", "minimum": 1, "maximum": 10},
    "bolt_sheet.thread_friction": {"type": "number", "minimum": 0.02, "maximum": 1},
    "bolt_sheet.head_friction": {"type": "number", "minimum": 0.02, "maximum": 1},
    "bolt_sheet.slip_friction": {"type": "number", "minimum": 0.02, "maximum": 2},
    "bolt_sheet.introduction": {"type": "number", "minimum": 0, "maximum": 1},
    "load.force.face": FACE,
    "load.pressure.face": FACE,
    "load.displacement.face": FACE,
    "load.force.force": POINT,
    "load.force.moment": POINT,
    "load.displacement.displacement": POINT,
    "load.acceleration": POINT,
    "load.temperature": {"type": "object", "additionalProperties": {"$ref": "#/$defs/quantity"}},
    "load.combine": {"type": "object", "additionalProperties": {"type": "number"}},
    "support.directions": listed({"enum": ["x", "y", "z"]}, 1, 3),
    "tightening.order": listed(TEXT, 1),
    "backbone.amplitude": listed({"$ref": "#/$defs/quantity"}, 2, 2),
    "backbone.friction": {"anyOf": [NUMBER, listed(NUMBER, 1)]},
    "backbone.law": {"anyOf": [TEXT, listed(TEXT, 1)]},
    "joint.tangential": {"anyOf": [*NUMBER["anyOf"], {"enum": ["law", "mindlin"]}]},
    "backbone.rest_damping": {"anyOf": [{"type": "number"}, {"const": "law"}]},
    "test.frequencies": listed(listed({"$ref": "#/$defs/quantity"}, 1), 1),
    "test.loss_factors": listed(listed({"type": ["number", "string"]}, 1), 1),
    "test.damping_ratios": listed(listed({"type": ["number", "string"]}, 1), 1),
    "test.published": listed(listed({"$ref": "#/$defs/quantity"}, 1), 1),
    "test.points": {"anyOf": [listed(POINT, 1), TEXT]},
    "test.direction": {"anyOf": [DIRECTION, {"enum": ["x", "y", "z"]}]},
    "test.least_mac": {"type": "number"},
    "test.greatest_shift": {"type": "number"},
    "uncertain": {"type": "object"},
    "law.model": TEXT,
}
# tables in which a key may be left out for another, which the readers judge
JUDGED = ("geometry", "test", "law", "surface")


def of_kind(key: Key) -> dict[str, Any]:
    """What may be written under a key that is no table."""
    if key.path in OWN:
        return dict(OWN[key.path])
    words = re.findall(r'"([^"]+)"', key.allowed)
    if key.kind == "text":
        return {"enum": words} if words and " or " in key.allowed else dict(TEXT)
    if key.kind == "file":
        return dict(TEXT)
    if key.kind.startswith("quantity"):
        return {"$ref": "#/$defs/quantity"}
    if key.kind.startswith("three lengths"):
        return dict(POINT)
    if key.kind.startswith("three numbers"):
        return dict(DIRECTION)
    if key.kind.startswith("true or false"):
        return {"type": "boolean"}
    if key.kind == "whole number":
        return {"type": "integer", "minimum": 1, "maximum": int(key.allowed.rpartition(" ")[2].replace(",", ""))}
    if key.kind == "number":
        return dict(NUMBER)
    raise ValueError(f"{key.path}: no schema for {key.kind!r}; add it to OWN")


def described(key: Key, words: dict[str, str]) -> str:
    """The sentence of a key, with its default."""
    said = words.get(key.path) or key.meaning
    return f"{said} Default: {key.default}." if key.default not in ("", "required") else said


def schema() -> dict[str, Any]:
    """The schema of a study file."""
    words = meanings(KEYS)
    tables: dict[str, dict[str, Any]] = {"": _table()}
    for key in recorded().values():
        holder = tables[key.table]
        if key.kind in ("table", "list of tables") or key.path in ("uncertain",):
            inner = tables.setdefault(key.path, _table())
            _put(holder, key, _holding(key, inner), described(key, words))
        else:
            _put(holder, key, of_kind(key), described(key, words))
    for copy in SAME_AS:
        start, _, last = copy.rpartition(".")
        original = tables["joint.form"] if last == "form" else tables[last]
        tables[copy].clear()
        tables[copy].update(original)
        assert start
    top = tables[""]
    top["properties"]["uncertain"] = {"type": "object", "description": words.get("uncertain", "")}
    selector = tables[f"geometry.face.{NAME}"]
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "$id": "faying.schema.json",
        "title": "A Faying study",
        **top,
        "$defs": {"quantity": QUANTITY, "selector": selector},
    }


def _table() -> dict[str, Any]:
    return {"type": "object", "properties": {}, "additionalProperties": False}


def _holding(key: Key, inner: dict[str, Any]) -> dict[str, Any]:
    return inner if key.kind == "table" else {"anyOf": [{"type": "array", "items": inner}, inner]}


def _put(holder: dict[str, Any], key: Key, what: dict[str, Any], said: str) -> None:
    """Put a key into the table that holds it; several laws may have a key of one name."""
    if key.name == NAME:
        holder["additionalProperties"] = what
        return
    if said and "type" in what and "properties" not in what:
        what = what | {"description": said}
    elif said and "properties" not in what and "anyOf" not in what:
        what = {"allOf": [what], "description": said} if "$ref" in what else what | {"description": said}
    elif said and "anyOf" in what:
        what = what | {"description": said}
    before = holder["properties"].get(key.name)
    if before is None or before == what:
        holder["properties"][key.name] = what
    else:
        kinds = before["anyOf"] if key.model and "anyOf" in before and before.get("title") == "laws" else [before]
        if what not in kinds:
            holder["properties"][key.name] = {"title": "laws", "anyOf": [*kinds, what]}
    if key.default == "required" and key.table not in JUDGED and key.kind != "list of tables":
        needed = holder.setdefault("required", [])
        if key.name not in needed:
            needed.append(key.name)


def text() -> str:
    """The schema as it is shipped."""
    return json.dumps(schema(), indent=1, ensure_ascii=False) + "\n"


if __name__ == "__main__":
    FILE.write_text(text(), encoding="utf-8")
    print(f"written: {FILE}")
