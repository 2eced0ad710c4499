"""The keys of a study as rows of the reference, from their declarations."""

from collections.abc import Iterator
from dataclasses import dataclass

from faying.study.declaration.declared import NAME, REQUIRED, Declared, Inner
from faying.study.declaration.declared import Key as DeclaredKey
from faying.study.keys.tables import STUDY

# tables with the keys of another one
SAME_AS = ("joint.surface", "joint.law", "alternative.surface", "alternative.law", "alternative.form")


@dataclass(frozen=True, kw_only=True)
class Key:
    """One key: its path, what is written there, its default and what is allowed."""

    path: str
    kind: str
    meaning: str
    default: str = ""
    allowed: str = ""
    model: str = ""  # the law that it is a parameter of

    @property
    def table(self) -> str:
        """The path of the table that it stands in."""
        return self.path.rpartition(".")[0]

    @property
    def name(self) -> str:
        """The key alone."""
        return self.path.rpartition(".")[2]


def keys(declared: Declared = STUDY, where: str = "") -> Iterator[Key]:
    """Every key of a study; those of tables that repeat the keys of another table are left out."""
    for name, what in declared.items():
        path = f"{where}.{name}" if where else name
        if isinstance(what, DeclaredKey):
            yield _row(path, what)
            continue
        yield Key(
            path=path,
            kind="list of tables" if what.many else "table",
            meaning=what.says,
            default="required" if what.required else "",
        )
        if path not in SAME_AS:
            yield from keys(what.keys, path)
            yield from _of_laws(what, path)


def _of_laws(inner: Inner, path: str) -> Iterator[Key]:
    for model, found in inner.models().items():
        for name, what in found.items():
            yield _row(f"{path}.{name}", what, model)


def _row(path: str, key: DeclaredKey, model: str = "") -> Key:
    default = "required" if key.default is REQUIRED else key.default_text
    return Key(path=path, kind=key.kind, meaning=key.says, default=default, allowed=key.allowed, model=model)


__all__ = ["NAME", "SAME_AS", "Key", "keys"]
