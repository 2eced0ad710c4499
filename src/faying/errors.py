"""What Faying raises at its users."""


class FayingError(Exception):
    """Base of every error that Faying raises on purpose; its text is written for the user."""


class InputError(FayingError, ValueError):
    """Something that was given cannot be used; the text says what is allowed and what to do."""


class ReadError(InputError):
    """A file is missing, damaged, of an unknown format, or lacks what is asked of it."""


class NotConverged(FayingError, RuntimeError):
    """An iteration stopped short of its tolerance; the text says where and how far it came."""
