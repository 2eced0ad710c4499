"""Calls that cannot be meant: an InputError says what was given, what is allowed and what to do."""

import inspect
import types
from collections.abc import Callable, Mapping, Sequence
from difflib import get_close_matches
from functools import cache, wraps
from pathlib import Path
from typing import Any, Literal, TypeVar, Union, get_args, get_origin

from numpy.typing import ArrayLike

from faying import checks
from faying.errors import InputError
from faying.typing import Array

Target = TypeVar("Target", bound=Callable[..., Any])
VARIADIC = (inspect.Parameter.VAR_POSITIONAL, inspect.Parameter.VAR_KEYWORD)
WORDS = {
    str: "text",
    float: "a number",
    int: "a whole number",
    bool: "True or False",
    Path: "a path",
    type(None): "None",
}


def checked_call(target: Target) -> Target:
    """Make a class or a function answer a wrong call with an InputError.

    Missing and unknown arguments are named with those that there are; values are compared with the types of the
    signature, as far as these say something that can be looked at.
    """
    if inspect.isclass(target):
        kind: Any = target
        kind.__init__ = _checked(kind.__init__, kind.__name__)
        return target
    out: Any = _checked(target, getattr(target, "__name__", "call"))
    return out  # type: ignore[no-any-return]


def _checked(function: Any, name: str) -> Any:
    @wraps(function)
    def call(*args: Any, **kwargs: Any) -> Any:
        signature, hints = _signature(function)
        try:
            given = signature.bind(*args, **kwargs).arguments
        except TypeError as fault:
            raise InputError(_wrong_call(name, signature, kwargs, str(fault))) from None
        for key, value in given.items():
            if key in hints and not matches(value, hints[key]):
                raise InputError(f"{name}: {key} = {shortened(value)}; give {described(hints[key])}")
            if isinstance(value, str | Path) and Path in (hints.get(key), *get_args(hints.get(key))):
                checks.path(value, f"{name}: {key}")
        return function(*args, **kwargs)

    return call


@cache
def _signature(function: Any) -> tuple[inspect.Signature, dict[str, Any]]:
    signature = inspect.signature(function)
    hints = {}
    for key, parameter in signature.parameters.items():
        if parameter.kind in VARIADIC or parameter.annotation is inspect.Parameter.empty:
            continue
        hint = parameter.annotation
        if isinstance(hint, str):
            try:
                hint = eval(hint, function.__globals__)
            except NameError:  # a name that only type checkers import
                continue
        hints[key] = hint
    return signature, hints


def _wrong_call(name: str, signature: inspect.Signature, kwargs: Mapping[str, Any], fault: str) -> str:
    known = [key for key in signature.parameters if key != "self"]
    needed = [
        key
        for key in known
        if signature.parameters[key].default is inspect.Parameter.empty
        and signature.parameters[key].kind not in VARIADIC
    ]
    unknown = [key for key in kwargs if key not in known]
    if unknown:
        near = get_close_matches(unknown[0], known, n=1)
        hint = f"; did you mean {near[0]}?" if near else ""
        return f"{name} takes no {unknown[0]}{hint}; it takes {', '.join(known)}"
    if not known:
        return f"{name} takes no arguments"
    wants = f"it needs {', '.join(needed)}" if needed else "it needs nothing"
    return f"{name}: {fault}; {wants}, and takes {', '.join(known)}"


def matches(value: object, hint: Any) -> bool:
    """Whether a value is of a type; True where the type says nothing that can be looked at."""
    origin, inner = get_origin(hint), get_args(hint)
    if hint is Any:
        return True
    if hint == ArrayLike:
        return _is_array(value)
    if origin in (Union, types.UnionType):
        return any(matches(value, part) for part in inner)
    if origin is Literal:
        return any(type(value) is type(part) and value == part for part in inner)
    if hint is None or hint is type(None):
        return value is None
    if hint in (float, int, bool):
        return _is_number(value, hint)
    if origin is tuple:
        return _is_tuple(value, inner)
    kind = origin or hint
    if not isinstance(kind, type) or (getattr(kind, "_is_protocol", False) and not _is_abstract(kind)):
        return True
    if kind.__module__ == "numpy":
        return _is_array(value, "biuf" if inner == get_args(Array) else "biufc")
    if issubclass(kind, tuple) and hasattr(kind, "_fields") and isinstance(value, tuple | list):
        return len(value) == len(kind._fields)  # a plain tuple will do for a named one
    if not isinstance(value, kind):
        return False
    if issubclass(kind, Mapping) and inner and isinstance(value, Mapping):
        return all(matches(key, inner[0]) and matches(part, inner[1]) for key, part in value.items())
    if _is_abstract(kind) and issubclass(kind, Sequence) and inner and isinstance(value, Sequence):
        return not isinstance(value, str | bytes) and all(matches(part, inner[0]) for part in value)
    return True


def _is_abstract(kind: type) -> bool:
    return kind.__module__ == "collections.abc"


def _is_number(value: object, hint: type) -> bool:
    import numpy as np

    if hint is bool:
        return isinstance(value, bool | np.bool_)
    if isinstance(value, bool | np.bool_):
        return False
    return isinstance(value, int | np.integer if hint is int else int | float | np.integer | np.floating)


def _is_array(value: object, kinds: str = "biufc") -> bool:
    """Whether a value is an array of numbers of these kinds (NumPy's letters), or can be made one."""
    import numpy as np

    if value is None or isinstance(value, str | bytes | bool | Mapping | Path):
        return False
    try:
        return np.asarray(value).dtype.kind in kinds
    except (TypeError, ValueError):
        return False


def _is_tuple(value: object, inner: tuple[Any, ...]) -> bool:
    import numpy as np

    if not isinstance(value, tuple | list | np.ndarray) or getattr(value, "ndim", 1) == 0:
        return False
    if len(inner) == 2 and inner[1] is Ellipsis:
        return all(matches(part, inner[0]) for part in value)
    return len(value) == len(inner) and all(matches(part, kind) for part, kind in zip(value, inner, strict=True))


def described(hint: Any) -> str:
    """A type in words."""
    origin, inner = get_origin(hint), get_args(hint)
    if hint == ArrayLike:
        return "an array of numbers"
    if origin in (Union, types.UnionType):
        words = list(dict.fromkeys(described(part) for part in inner))
        return words[0] if len(words) == 1 else f"{', '.join(words[:-1])} or {words[-1]}"
    if origin is Literal:
        return " or ".join(f'"{part}"' if isinstance(part, str) else repr(part) for part in inner)
    if hint in WORDS:
        return WORDS[hint]
    if origin is tuple:
        if len(inner) == 2 and inner[1] is Ellipsis:
            return f"a tuple of {described(inner[0])}"
        return f"({', '.join(described(part) for part in inner)})"
    kind = origin or hint
    if not isinstance(kind, type):
        return str(hint)
    if _is_abstract(kind) and issubclass(kind, Mapping) and inner:
        return f"a mapping from {described(inner[0])} to {described(inner[1])}"
    if _is_abstract(kind) and issubclass(kind, Sequence) and inner:
        return f"a list of {described(inner[0])}"
    if _is_abstract(kind):
        return "a function" if kind.__name__ == "Callable" else f"a {kind.__name__.lower()}"
    if kind.__module__ == "numpy":
        return "an array of numbers"
    return f"{'an' if kind.__name__[0] in 'AEIOU' else 'a'} {kind.__name__}"


def shortened(value: object) -> str:
    """What was given, as text of at most a line."""
    import numpy as np

    if isinstance(value, np.ndarray) and value.size > 8:
        return f"an array of shape {value.shape}"
    try:
        text = repr(value)
    except Exception:  # of an object of the user's
        text = f"an object of type {type(value).__name__}"
    text = " ".join(text.split())
    if len(text) <= 80:
        return text
    return f"{text[:60]}... ({type(value).__name__})"


def numbers(value: Any, name: str, *shape: int | str) -> Array:
    """A value as an array of floats.

    Args:
        value: What was given.
        name: What the error calls it.
        shape: Length of each dimension, or its name where any will do.

    Raises:
        InputError: It is not an array of numbers, or has another shape.
    """
    import numpy as np

    words = ", ".join(map(str, shape))
    if not _is_array(value, "biuf"):
        raise InputError(f"{name} = {shortened(value)}; give an array of numbers of the shape ({words})")
    out = np.asarray(value, dtype=float)
    if out.ndim != len(shape) or any(isinstance(b, int) and a != b for a, b in zip(out.shape, shape, strict=True)):
        raise InputError(f"{name} has the shape {out.shape}; give ({words})")
    return out
