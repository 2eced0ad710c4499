"""Where the results of a study lie, so that two studies in one folder do not overwrite each other's."""

from pathlib import Path

FOLDER, PLAIN = "results", "study"  # the folder, and the name of the study whose files lie in it directly


def results_folder(folder: Path, name: str) -> Path:
    """The folder of the results of a study.

    Args:
        folder: that of the study file.
        name: of the study file, without its suffix.

    Returns:
        `results` for `study.toml`, `results/NAME` for `NAME.toml`.
    """
    return folder / FOLDER if name == PLAIN else folder / FOLDER / name
