"""Arrays that take long to make, kept from one run to the next in a folder beside the user's file."""

import hashlib
import os
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

from faying.errors import InputError
from faying.files import load_arrays, write_arrays

FOLDER = ".faying"  # beside a scan it keeps solved contacts, beside a STEP file meshes; it can be deleted at any time


def kept(
    make: Callable[[], Mapping[str, Any]], folder: Path | None, *, kind: str, key: str, data: bytes
) -> Mapping[str, Any]:
    """Return arrays from the cache, or make them and keep them there.

    Args:
        make: returns the arrays by name.
        folder: where they are kept; None keeps nothing. FAYING_CACHE names another folder for all, or is "off".
        kind: what they are, in a file's name.
        key: all that they depend on beside the data, with the version of what is kept.
        data: what was read, heights or a file.

    A damaged file is made anew. Where the folder cannot be written, nothing is kept.
    """
    asked = os.environ.get("FAYING_CACHE", "")
    place = None if asked == "off" else Path(asked) if asked else folder
    if place is None:
        return make()
    digest = hashlib.sha256(key.encode() + data).hexdigest()
    file = place / f"{kind}-{digest[:24]}.npz"
    found = load_arrays(file)
    if found is not None:
        return found
    arrays = make()
    try:
        place.mkdir(exist_ok=True)
        write_arrays(file, arrays)
    except (InputError, OSError):
        pass
    return arrays
