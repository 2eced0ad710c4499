"""The JSON schema of a study, from its declarations: what `faying schema` gives to editors and to the page."""

import json
import tomllib
from collections.abc import Mapping
from functools import cache
from typing import Any

from faying.study.declaration.declared import NAME, NUMERAL, REQUIRED, Declared, Inner, Key
from faying.study.keys.face import SELECTOR
from faying.study.keys.tables import STUDY

SCATTERS = r".*(?: to |\+-|\+/-|±).*"  # a number that scatters: "0.1 to 0.6", "200 GPa +- 4 GPa"
DEFINITIONS = {
    "quantity": {"type": "string", "pattern": rf"^\s*{NUMERAL}\s*([^0-9\s.]|1\s*/)"},
    "number": {"anyOf": [{"type": "number"}, {"type": "string", "pattern": rf"^\s*{NUMERAL}{SCATTERS}$"}]},
}


@cache
def schema_text() -> str:
    """The schema as text."""
    return json.dumps(schema(), indent=1, ensure_ascii=False) + "\n"


def schema() -> dict[str, Any]:
    """The schema of a study file, JSON Schema 2020-12."""
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "$id": "faying.schema.json",
        "title": "A Faying study",
        **_table(Inner(says="", keys=STUDY)),
        "$defs": DEFINITIONS | {"selector": _table(Inner(says="", keys=SELECTOR))},
    }


def _table(inner: Inner) -> dict[str, Any]:
    if inner.free:
        return {"type": "object"}
    properties = {name: _one(what) for name, what in inner.keys.items() if name != NAME} | _of_models(inner.models())
    out: dict[str, Any] = {"type": "object", "properties": properties}
    out["additionalProperties"] = _one(inner.keys[NAME]) if NAME in inner.keys else False
    needed = [name for name, what in inner.keys.items() if name != NAME and _needed(what)]
    return out | ({"required": needed} if needed and not inner.either else {})


def _needed(what: Key | Inner) -> bool:
    return what.default is REQUIRED if isinstance(what, Key) else what.required and not what.many


def _one(what: Key | Inner) -> dict[str, Any]:
    if isinstance(what, Key):
        return _described(what.schema, what)
    table = _table(what)
    found = {"anyOf": [{"type": "array", "items": table}, table]} if what.many else table
    return found | {"description": what.says}


def _described(schema: Mapping[str, Any], key: Key) -> dict[str, Any]:
    default = key.default_text
    says = f"{key.says} Default: {default}." if default else key.says
    found = {"allOf": [schema]} if "$ref" in schema else dict(schema)
    more: dict[str, Any] = {"x-unit": key.unit, "examples": list(key.examples())}
    if default:
        more["default"] = tomllib.loads(f"default = {default}")["default"]
    return found | {"description": says} | {name: value for name, value in more.items() if value not in ("", [])}


def _of_models(models: Mapping[str, Declared]) -> dict[str, Any]:
    """Parameters of laws; one that several laws have takes what any of them takes."""
    by_name: dict[str, list[dict[str, Any]]] = {}
    owners: dict[str, list[str]] = {}
    for label, keys in models.items():
        for name, what in keys.items():
            kinds, one = by_name.setdefault(name, []), _one(what)
            owners.setdefault(name, []).append(label.lower())
            kinds += [] if one in kinds else [one]
    return {
        name: (kinds[0] if len(kinds) == 1 else {"title": "laws", "anyOf": kinds}) | {"x-laws": owners[name]}
        for name, kinds in by_name.items()
    }
