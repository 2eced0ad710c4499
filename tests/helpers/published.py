"""Published numbers beside ours: each comparison asserts, and writes itself into a table where that is asked for.

`FAYING_VALIDATION=docs/validation.json pytest -m "slow or not slow"` renews the table of the site. Entries of tests
that did not run stay as they were, with the version and the date of their own run.
"""

import json
import os
import time
from contextlib import contextmanager
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path

import pytest

import faying

VARIABLE = "FAYING_VALIDATION"
KEYS = ("source", "quantity", "unit", "published", "ours", "tolerance", "relative", "why", "test", "version", "date")
MEASURED = "measured"  # the last key of numbers that somebody measured


@dataclass(frozen=True)
class Published:
    """Compares with published numbers on behalf of one test."""

    test: str

    def __call__(self, quantity, published, ours, *, source, unit="1", rel=None, tol=None, why="", measured=False):
        """Assert that ours is within `rel` (share of the published value) or `tol` (in its unit); note both.

        quantity: what it is, in words that stand alone; source: "doi:..." or a book or standard with its place; unit:
        of both numbers, "1" for none; why: what explains the difference, or why the tolerance is what it is; measured:
        whether somebody measured the published number, in place of computing or prescribing it.
        """
        assert (rel is None) != (tol is None), "give rel or tol"
        published, ours = float(published), float(ours)
        self._note(
            {
                "source": source,
                "quantity": quantity,
                "unit": unit,
                "published": float(f"{published:.6g}"),
                "ours": float(f"{ours:.6g}"),
                "tolerance": rel if rel is not None else tol,
                "relative": rel is not None,
                "why": why,
                "test": self.test,
                "version": faying.__version__,
                "date": datetime.now(UTC).date().isoformat(),
                **({MEASURED: True} if measured else {}),
            }
        )
        expected = pytest.approx(published, rel=rel) if rel is not None else pytest.approx(published, abs=tol)
        assert ours == expected, f"{quantity} [{unit}]: {ours:.6g}, published {published:g} ({source})"

    @staticmethod
    def _note(entry):
        name = os.environ.get(VARIABLE)
        if not name:
            return
        path = Path(name)
        with _alone(path):
            entries = json.loads(path.read_text(encoding="utf-8")) if path.is_file() else []
            kept = {(one["test"], one["quantity"]): one for one in entries}
            kept[entry["test"], entry["quantity"]] = entry
            ordered = [kept[key] for key in sorted(kept)]
            new = path.with_suffix(".new")
            new.write_text(json.dumps(ordered, indent=1, ensure_ascii=False) + "\n", encoding="utf-8")
            new.replace(path)


@contextmanager
def _alone(path):
    """Keep the other workers of a run out."""
    lock = path.with_suffix(".lock")
    while True:
        try:
            os.close(os.open(lock, os.O_CREAT | os.O_EXCL))
            break
        except FileExistsError:
            time.sleep(0.01)
    try:
        yield
    finally:
        lock.unlink()
