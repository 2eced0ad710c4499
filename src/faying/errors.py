"""What Faying raises at its users, and how an error calls what was given."""


class FayingError(Exception):
    """Base of every error that Faying raises on purpose; its text is written for the user."""


class InputError(FayingError, ValueError):
    """Something that was given cannot be used; the text says what is allowed and what to do."""


class ReadError(InputError):
    """A file is missing, damaged, of an unknown format, or lacks what is asked of it."""


class NotConverged(FayingError, RuntimeError):
    """An iteration stopped short of its tolerance; the text says where and how far it came."""


def shown(value: object) -> str:
    """What was given, in one short line: its text where that is short, else its type and size."""
    if isinstance(value, str):
        text = repr(value)
        return text if len(text) <= 60 and text.isprintable() else f"text of {len(value)} characters"
    shape = getattr(value, "shape", None)
    if isinstance(shape, tuple) and shape:
        return f"an array of shape {shape}"
    if value is None or isinstance(value, bool | int | float | complex):
        text = repr(value)
        return text if len(text) <= 60 else f"a number of {len(text)} digits"
    if isinstance(value, list | tuple | dict | set) and len(value) <= 4:
        text = repr(value)
        if len(text) <= 60 and text.isprintable():
            return text
    return f"an object of type {type(value).__name__}"
