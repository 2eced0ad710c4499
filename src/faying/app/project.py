"""A project: a folder with a study, what was put beside it, and its results."""

import re
from dataclasses import dataclass
from io import BufferedIOBase
from pathlib import Path
from typing import Any, final, get_args

from faying.errors import InputError
from faying.file_kinds import STUDY, Use, kind_held, kind_of, taken
from faying.files import write_atomically, write_text
from faying.study.study import results_folder

SHOWN: tuple[Use, ...] = ("geometry", "mesh", "scan", "test", "study")  # what the page offers files for
NAME = re.compile(r"[\w()+\- ][\w.()+\- ]{0,118}", re.ASCII)
LARGEST = 1 << 30  # bytes of an upload
LARGEST_STUDY = 1 << 20  # bytes of a study's text
BLOCK = 1 << 20


@final
@dataclass(frozen=True, kw_only=True)
class Project:
    """A folder and the name of its study, which need not exist yet."""

    folder: Path
    study_name: str = "study.toml"

    @classmethod
    def at(cls, place: Path) -> "Project":
        """The project of a folder or of a study file. Raises InputError where it is neither, or has several studies."""
        if place.is_file():
            if kind_of(place) is not STUDY:
                raise InputError(f"{place} is not a study; give a folder, or a study file")
            return cls(folder=place.resolve().parent, study_name=place.name)
        if not place.is_dir():
            raise InputError(f"no folder {place}; make it first, or give another")
        studies = sorted(path.name for path in place.glob("*.toml") if kind_held(path) is STUDY)
        if len(studies) > 1 and "study.toml" not in studies:
            raise InputError(
                f"{place} has several studies: {', '.join(studies)}; name one, such as faying app {place / studies[0]}"
            )
        name = "study.toml" if len(studies) != 1 else studies[0]
        return cls(folder=place.resolve(), study_name=name)

    @property
    def study(self) -> Path:
        """The study file, which may not exist yet."""
        return self.folder / self.study_name

    @property
    def results(self) -> Path:
        """Where results lie, which may not exist yet."""
        return results_folder(self.folder, Path(self.study_name).stem)

    @property
    def results_name(self) -> str:
        """The same as it is called from the folder."""
        return self.results.relative_to(self.folder).as_posix()

    def file(self, name: str) -> Path:
        """The path of a file that lies in the folder itself. Raises InputError for names that lead elsewhere."""
        return _inside(self.folder, checked_name(name))

    def result(self, name: str) -> Path:
        """The path of a file of the results. Raises InputError for names that lead elsewhere, or to none."""
        path = _inside(self.results, checked_name(name))
        if not path.is_file():
            raise InputError(f"no result {name!r}")
        return path

    def listed(self) -> dict[str, Any]:
        """What lies in the folder, for the page."""
        files = [{"name": path.name, "size": path.stat().st_size, "kinds": _uses(path)} for path in self._files()]
        made = sorted(self.results.iterdir()) if self.results.is_dir() else []
        results = [path.name for path in made if path.is_file() and path.name[0] != "."]
        known = {"folder": str(self.folder), "study": self.study_name, "files": files}
        return {**known, "results": results, "text": self.text()}

    def by_kind(self) -> dict[str, list[str]]:
        """The names of the files in the folder, by what they may be."""
        uses = {path.name: _uses(path) for path in self._files()}
        return {use: [name for name, some in uses.items() if use in some] for use in SHOWN}

    def _files(self) -> list[Path]:
        files = sorted(self.folder.iterdir())
        return [path for path in files if path.is_file() and not path.name.startswith(".") and _uses(path)]

    def text(self) -> str | None:
        """The study's text; None where there is no study yet."""
        return self.study.read_text(encoding="utf-8", errors="replace") if self.study.is_file() else None

    def save_text(self, text: str, before: str) -> None:
        """Replace the study's text. Raises InputError where it is no longer what it was before, or far too long."""
        if (self.text() or "") != before:
            raise InputError(
                f"{self.study_name} was changed outside of this page and is not replaced; copy what you typed, and "
                "reload the page"
            )
        if len(text.encode()) > LARGEST_STUDY:
            raise InputError(f"the study has more than {LARGEST_STUDY >> 20} MB; nothing was saved")
        write_text(self.study, text)

    def receive(self, name: str, source: BufferedIOBase, size: int, *, replace: bool = False) -> Path:
        """Write `size` bytes of a stream into the folder; the file appears complete or not at all.

        A file that is there is replaced only where that is wanted: it may be an hour's work. Raises InputError
        otherwise.
        """
        path = self.file(name)
        if path.is_file() and not replace:
            raise InputError(f"{name} is there already; say that it is to be replaced, or give the file another name")

        def write(temporary: Path) -> None:
            left = size
            with temporary.open("wb") as file:
                while left:
                    block = source.read(min(left, BLOCK))
                    if not block:
                        raise InputError(f"{name!r} ended {left:,} bytes early; send it again")
                    file.write(block)
                    left -= len(block)
            taken(temporary, *get_args(Use), name=name)

        return write_atomically(path, write)


def checked_name(name: str) -> str:
    """A bare file name. Raises InputError for folders, hidden files and characters that not every system takes."""
    if not NAME.fullmatch(name) or name.endswith((" ", ".")):
        raise InputError(
            f"{name[:80]!r} is not a file name that Faying accepts; use letters, digits, blanks and . _ - + ( ), at "
            "most 119, with no folder and no dot at either end"
        )
    return name


def _inside(folder: Path, name: str) -> Path:
    path = folder / name
    if not path.resolve().is_relative_to(folder.resolve()):
        raise InputError(f"{name!r} leads out of the folder {folder}")
    return path


def _uses(path: Path) -> list[str]:
    kind = kind_of(path)
    return [] if kind is None else [use for use in kind.serves if use in SHOWN]
