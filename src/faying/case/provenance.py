"""What a result was made from: the study's text, its files, versions, date."""

import hashlib
from datetime import UTC, datetime
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Any

from faying.result import Provenance
from faying.study.study import Study

VERSIONS = ("faying", "numpy", "scipy", "netgen-mesher", "pypardiso", "mkl")


def provenance(study: Study) -> Provenance:
    """The study's text, a hash of every file that it names, versions and the date."""
    return Provenance(
        study=study.text,
        files={str(_below(file, study.folder)): hashlib.sha256(file.read_bytes()).hexdigest() for file in study.files},
        versions={name: found for name in VERSIONS if (found := _version(name))},
        date=datetime.now(UTC).isoformat(timespec="seconds"),
    )


def _below(file: Path, folder: Path) -> Path:
    return file.relative_to(folder) if file.is_relative_to(folder) else file


def _version(name: str) -> Any:
    try:
        return version(name)
    except PackageNotFoundError:
        return ""
