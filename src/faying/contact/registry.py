"""The list of contact laws, found among the files of this package."""

from functools import cache
from importlib import import_module
from inspect import isabstract, isclass
from pkgutil import iter_modules

from faying.contact.law import ContactLaw
from faying.errors import InputError


@cache
def _found() -> tuple[tuple[str, type[ContactLaw]], ...]:
    package = import_module("faying.contact")
    # a module or a subpackage each; a class belongs to the one that it was written in
    found: dict[str, type[ContactLaw]] = {}
    for entry in iter_modules(package.__path__):
        module = import_module(f"faying.contact.{entry.name}")
        for name, value in vars(module).items():
            own = isclass(value) and issubclass(value, ContactLaw) and value.__module__.startswith(module.__name__)
            if own and not isabstract(value) and "name" in vars(value):
                found[name] = value
    return tuple(sorted(found.items()))


def laws() -> dict[str, type[ContactLaw]]:
    """Return every contact law by the name of its class, in alphabetical order."""
    return dict(_found())


def find_law(name: str) -> type[ContactLaw]:
    """Return the law called `name`, by its class or its short name ("gw"), in any case, with or without hyphens.

    InputError lists the known ones.
    """

    def plain(text: str) -> str:
        return text.strip().lower().replace("-", "").replace("_", "")

    known = {plain(law.name): law for _, law in _found()} | {plain(key): law for key, law in _found()}
    law = known.get(plain(name))
    if law is None:
        listed = ", ".join(key if key == law.name else f"{key} ({law.name})" for key, law in _found())
        raise InputError(f"no contact law {name!r}; known are {listed}")
    return law
