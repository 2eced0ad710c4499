"""The last results of a study, kept as copies so that two runs can be compared."""

import hashlib
import re
from base64 import b64encode
from collections.abc import Iterator, Mapping
from datetime import UTC, datetime
from io import BytesIO
from pathlib import Path
from typing import Any, final

from faying.app.project import Project
from faying.cache import FOLDER
from faying.errors import FayingError, InputError
from faying.files import make_folder, write_atomically
from faying.result import Result
from faying.setup.edit import KeyPath, name_of, written
from faying.text import toml
from faying.units import load_text

MAX_RUNS = 8  # results that are kept
MAX_BYTES = 2 << 30  # that they may have together
NAME = re.compile(r"[0-9]{8}-[0-9]{6}-[0-9a-f]{8}")


@final
class Runs:
    """Copies of result.nc under .faying/runs/STUDY, which can be deleted at any time.

    A run is kept when it is seen, whether the page or the command line has made it. Equal results are kept once.
    """

    def __init__(self, project: Project) -> None:
        self.project = project
        self.folder = project.folder / FOLDER / "runs" / Path(project.study_name).stem
        self._seen: tuple[int, int] | None = None
        self._said: dict[str, dict[str, Any]] = {}

    def keep(self) -> None:
        """Copy the present result, where it is a new one. A folder that cannot be written keeps none."""
        result = self.project.results / "result.nc"
        try:
            state = result.stat()
            if self._seen == (state.st_mtime_ns, state.st_size):
                return
            data = result.read_bytes()
            digest = hashlib.sha256(data).hexdigest()[:8]
            if not any(name.endswith(digest) for name in self.names()):
                date = datetime.fromtimestamp(state.st_mtime, UTC)
                make_folder(self.folder, "free its name in the folder")
                write_atomically(self.folder / f"{date:%Y%m%d-%H%M%S}-{digest}.nc", lambda path: path.write_bytes(data))
            self._seen = (state.st_mtime_ns, state.st_size)
            self._forget()
        except (OSError, FayingError):
            return

    def _forget(self) -> None:
        """Delete the oldest where they are more, or larger, than what is kept; the newest stays."""
        size = 0
        for k, name in enumerate(self.names()):
            size += self._file(name).stat().st_size
            if k and (k >= MAX_RUNS or size > MAX_BYTES):
                self._file(name).unlink()

    def names(self) -> list[str]:
        """Names of the runs, the newest first."""
        if not self.folder.is_dir():
            return []
        return sorted((file.stem for file in self.folder.glob("*.nc") if NAME.fullmatch(file.stem)), reverse=True)

    def listed(self) -> list[dict[str, Any]]:
        """Each run with its date, title, laws and preloads, and what its study says otherwise than the run before."""
        runs = [self._facts(name) for name in self.names()]
        studies = [one.pop("study", "") for one in runs]
        for k, one in enumerate(runs):
            one["changes"] = changes(studies[k + 1], studies[k]) if k + 1 < len(runs) else []
        return runs

    def compared(self, first: str, second: str, preload: str = "") -> dict[str, Any]:
        """Compare two runs: what differs in their studies, modes and joints, a figure, notes.

        preload: at which, as text; "" for the last that both have.

        Raises:
            InputError: there is no such run or preload, or a run cannot be read.
        """
        from faying.result.difference import compare_runs, differences, shared_preloads

        results = self._load(first), self._load(second)
        found = compare_runs(*results, preload or None)
        with BytesIO() as picture:
            differences(found).savefig(picture, format="svg")
            drawn = b64encode(picture.getvalue()).decode()
        texts = [one.provenance.study for one in results]
        files = [one.provenance.files for one in results]
        other = sorted(name for name in files[0] if name in files[1] and files[0][name] != files[1][name])
        return {
            "preloads": list(map(load_text, found.preloads)),
            "shared": [results[0].load_names[at] for at, _ in shared_preloads(*results)],
            "changes": [*changes(*texts), *([name, "file", "other content"] for name in other)],
            "modes": found.mode_rows(),
            "joints": found.joint_rows(),
            "notes": list(found.notes),
            "picture": drawn,
        }

    def _file(self, name: str) -> Path:
        return self.folder / f"{name}.nc"

    def _load(self, name: str) -> Result:
        if not NAME.fullmatch(name) or not self._file(name).is_file():
            raise InputError(f"no run {name[:40]!r}; look at the list again")
        return Result.load(self._file(name))

    def _facts(self, name: str) -> dict[str, Any]:
        if name not in self._said:
            date = datetime.strptime(name[:15], "%Y%m%d-%H%M%S").replace(tzinfo=UTC)
            facts: dict[str, Any] = {"id": name, "date": date.isoformat()}
            try:
                result = self._load(name)
            except FayingError as fault:  # of another version, or damaged: it is listed, and says so when it is taken
                facts |= {"title": str(fault), "laws": [], "preloads": [], "study": ""}
            else:
                laws = dict.fromkeys(str(law.get("law", law.get("name", ""))) for law in result.laws)
                facts |= {"title": result.title, "laws": list(laws), "preloads": list(result.load_names)}
                facts["study"] = result.provenance.study
            self._said[name] = facts
        return dict(self._said[name])


def changes(before: str, after: str) -> list[list[str]]:
    """Return the keys in which two texts of a study differ: key, what it was, what it is; "-" where it is left out."""
    old, new = (dict(_leaves(_parsed(text))) for text in (before, after))
    keys = [*old, *(key for key in new if key not in old)]
    return [[key, old.get(key, "-"), new.get(key, "-")] for key in keys if old.get(key, "-") != new.get(key, "-")]


def _parsed(text: str) -> Mapping[str, Any]:
    try:
        return toml(text)
    except ValueError:
        return {}


def _leaves(data: Any, path: KeyPath = ()) -> Iterator[tuple[str, str]]:
    if isinstance(data, Mapping):
        for name, inner in data.items():
            yield from _leaves(inner, (*path, name))
    elif isinstance(data, list) and data and all(isinstance(one, Mapping) for one in data):
        for k, inner in enumerate(data):
            yield from _leaves(inner, (*path, k))
    else:
        yield name_of(path), data if isinstance(data, str) else written(data)
