"""Python files that a study names: they are run, so only those count that have come with it."""

import hashlib
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from contvines.command.sentences import refused
from contvines.shared.files import module_of, names_of


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
            f'beside {study.name}; for example "{name.name}"'
        )
    return study.parent / name


def load_kinds(study: Path, said: str) -> tuple[Sequence[Any], str]:
    """The built-in kinds with those of a file beside the study, and a digest of the file; the file is run.

    Parameters
    ----------
    study : Path
    said : str
        File and name, ``kinds = "file.py:name"`` in [continue]; the name is that of a :class:`contvines.Kind`, or of a list of them.

    Raises
    ------
    ValueError
        If there is no such file beside the study, it does not run, or has no kinds of that name.
    """
    from contvines.bifurcation.kind import Kind
    from contvines.bifurcation.kinds import KINDS, checked

    place = f"[continue] kinds = {said!r}"
    file, _, name = said.rpartition(":")
    path = own_code(study, file, place)
    if not (file and name and path.is_file()):
        raise ValueError(
            f'{place}: name a file beside the study and a kind in it, for example kinds = "saddles.py:neutral"'
        )
    with refused(place):
        module = module_of(path)
    found = getattr(module, name, None)
    own = [found] if isinstance(found, Kind) else list(found) if isinstance(found, list | tuple) else []
    if not own:
        known = ", ".join(names_of(module, Kind)) or "none"
        raise ValueError(f"{place}: {path} has no kind {name!r}; it has {known}")
    try:
        digest = hashlib.sha256(path.read_bytes()).hexdigest()[:16]
        return checked([*(kind for kind in KINDS if kind not in own), *own]), digest
    except ValueError as error:
        raise ValueError(f"[continue] {error}") from None
