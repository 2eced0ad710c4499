"""Memory that can still be taken: asked before work that needs much of it."""

import os
from pathlib import Path

from faying.errors import InputError

GB = 1e9
CGROUP = Path("/sys/fs/cgroup")


def available() -> float | None:
    """Memory [B] that can still be taken, of the machine, the container and the process; None where it is not known.

    The environment's FAYING_MEMORY, in GB, stands in place of all of them.
    """
    given = os.environ.get("FAYING_MEMORY", "").strip()
    if given:
        try:
            value = float(given)
        except ValueError:
            value = -1.0
        if not value > 0:
            raise InputError(f"FAYING_MEMORY={given!r} should be a number of gigabytes such as 24, or inf")
        return value * GB
    found = [value for value in (_machine(), _container(), _process()) if value is not None]
    return min(found) if found else None


def require(needed: float, what: str, remedy: str) -> None:
    """Raise InputError where work needs more memory [B] than there is; what: the work, remedy: what asks for less."""
    free = available()
    if free is not None and needed > free:
        raise InputError(
            f"{what} need about {needed / GB:.3g} GB and {free / GB:.3g} GB are free; {remedy}, or set FAYING_MEMORY "
            "to the GB that may be taken"
        )


def _machine() -> float | None:
    try:
        for line in Path("/proc/meminfo").read_text(encoding="ascii").splitlines():
            if line.startswith("MemAvailable:"):
                return float(line.split()[1]) * 1024
    except (OSError, ValueError, IndexError):
        pass
    try:  # no /proc, as on macOS: what is built in
        return float(os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE"))
    except (AttributeError, OSError, ValueError):
        return None


def _container() -> float | None:
    """What a control group leaves: version 2, else version 1. Pages of files can be dropped."""
    for limit, used, stat, word in (
        ("memory.max", "memory.current", "memory.stat", "inactive_file"),
        ("memory/memory.limit_in_bytes", "memory/memory.usage_in_bytes", "memory/memory.stat", "total_inactive_file"),
    ):
        try:
            most = float((CGROUP / limit).read_text(encoding="ascii").replace("max", "inf"))
            taken = float((CGROUP / used).read_text(encoding="ascii"))
            pages = dict(line.split() for line in (CGROUP / stat).read_text(encoding="ascii").splitlines())
            return max(most - taken + float(pages.get(word, 0)), 0.0)
        except (OSError, ValueError):
            continue
    return None


def _process() -> float | None:
    """What a limit on the address space (ulimit -v) leaves."""
    try:
        import resource

        most = resource.getrlimit(resource.RLIMIT_AS)[0]
        if most == resource.RLIM_INFINITY:
            return None
        taken = float(Path("/proc/self/statm").read_text(encoding="ascii").split()[0]) * resource.getpagesize()
    except (ImportError, OSError, ValueError):
        return None
    return max(most - taken, 0.0)
