"""Python files that a study names: they are run, so only those count that have come with it."""

from pathlib import Path


def own_code(study: Path, file: str, place: str) -> Path:
    """A Python file that a study names, in the study's folder or in a folder inside it.

    Parameters
    ----------
    study : Path
        Of the study.
    file : str
        As the study names it.
    place : str
        The field of the study with its value, for the refusal.

    Raises
    ------
    ValueError
        If the name leads out of the study's folder. (A link in the folder may lead out: somebody has put it there.)
    """
    name = Path(file)
    if name.is_absolute() or ".." in name.parts:
        raise ValueError(
            f"{place}: a study runs Python files of its own folder (or of folders in it) only; put {name.name}, or a link to it, "
            f'beside {study.name}; "{name.name}" would do'
        )
    return study.parent / name
