"""Files of Python that a result names, where they lie now: they may have been moved together with the result."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from pathlib import Path, PureWindowsPath
from typing import Any


def found_again(content: Mapping[str, Any], folders: Iterable[Path]) -> dict[str, Any]:
    """Contents of a file, with the places of machine files and of files of equations that are gone replaced by those in which they are found.

    A file is looked for in some folders by the end of its path: ``machines/press.py``, then the longer ends. Whether its text is the one that
    was used is judged by whoever runs it.

    Parameters
    ----------
    content : mapping
    folders : iterable of Path
        That of the result, and that of its study.
    """
    places: dict[str, str] = {}
    return {name: _placed(value, list(folders), places) for name, value in content.items()}


def _placed(value: object, folders: list[Path], places: dict[str, str]) -> object:
    if isinstance(value, str) and value.endswith(".py"):
        if value not in places:
            places[value] = _place(value, folders)
        return places[value]
    if isinstance(value, Mapping):
        return {name: _placed(part, folders, places) for name, part in value.items()}
    return [_placed(part, folders, places) for part in value] if isinstance(value, list) else value


def _place(path: str, folders: list[Path]) -> str:
    parts = PureWindowsPath(path).parts  # either kind of slash
    if len(parts) < 2 or "\n" in path or Path(path).exists():
        return path
    for taken in range(1, len(parts)):
        for folder in folders:
            place = folder.joinpath(*parts[-taken:])
            if place.is_file():
                return str(place)
    return path
