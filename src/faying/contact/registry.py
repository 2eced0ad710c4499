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
    found: dict[str, type[ContactLaw]] = {}
    for entry in iter_modules(package.__path__):
        if entry.ispkg:
            continue
        module = import_module(f"faying.contact.{entry.name}")
        for name, value in vars(module).items():
            own = isclass(value) and issubclass(value, ContactLaw) and value.__module__ == module.__name__
            if own and not isabstract(value) and not name.startswith("_"):
                found[name] = value
    return tuple(sorted(found.items()))


def laws() -> dict[str, type[ContactLaw]]:
    """Return every contact law by the name of its class, in alphabetical order."""
    return dict(_found())


def find_law(name: str) -> type[ContactLaw]:
    """Return the law called `name`; case, hyphens and underscores do not matter. InputError lists the known ones."""
    plain = {key.lower(): value for key, value in _found()}
    law = plain.get(name.lower().replace("-", "").replace("_", ""))
    if law is None:
        raise InputError(f"no contact law {name!r}; known are {', '.join(key for key, _ in _found())}")
    return law
