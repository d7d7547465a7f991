"""Files: checks of paths, CSV tables, execution of Python files that a user names, and digests that identify runs."""

from __future__ import annotations

import csv
import hashlib
import json
import sys
from collections.abc import Iterable
from importlib.util import module_from_spec, spec_from_file_location
from pathlib import Path
from types import ModuleType

ENDINGS = (
    "vines",
    "toml",
    "csv",
    "json",
    "graphml",
    "mat",
    "png",
    "pdf",
    "svg",
    "jpg",
    "eps",
    "txt",
    "py",
    "xls",
    "xlsx",
)
OTHER_ENDINGS = {"csv": ("txt",)}  # endings that fit beside the usual one


def write_csv(path: str | Path, head: Iterable[str], rows: Iterable[Iterable[object]]) -> None:
    """Write a CSV file: a line with the column heads, then a line per row.

    Raises
    ------
    OSError
        If the file cannot be written.
    """
    with Path(path).open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file)
        writer.writerow(head)
        writer.writerows(rows)


def digest_of(data: object) -> str:
    """Return a digest of JSON-able data; stored in files since version 0.1, so it must not change."""
    return hashlib.sha256(json.dumps(data, sort_keys=True, default=str).encode()).hexdigest()


def module_of(path: str | Path) -> ModuleType:
    """Run a Python file and return it as a module; it is run once per process, and again after its text has changed.

    Call it only for a file that the user has named.

    Raises
    ------
    OSError
        If it cannot be read.
    ValueError
        If it is no Python file, or raises an error.
    """
    file = Path(path).resolve()
    digest = hashlib.sha256(str(file).encode() + file.read_bytes()).hexdigest()[:16]
    name = f"_own_{file.stem}_{digest}"
    if name not in sys.modules:
        spec = spec_from_file_location(name, file)
        if spec is None or spec.loader is None:
            raise ValueError(f"{path}: this is no Python file")
        module = sys.modules[name] = module_from_spec(spec)
        try:
            spec.loader.exec_module(module)
        except Exception as error:
            del sys.modules[name]
            raise ValueError(f"{path}: the file does not run: {type(error).__name__}: {error}") from error
    return sys.modules[name]


def names_of(module: ModuleType, kind: type) -> list[str]:
    """Return the names of a module's objects that are instances of a type."""
    return [name for name, value in vars(module).items() if isinstance(value, kind)]


def refuse_ending(path: Path, ending: str) -> None:
    """Raise an error if a path has the ending of another kind of file; no ending and unknown endings are allowed.

    Parameters
    ----------
    path : Path
        Of the file to be written.
    ending : str
        Of its kind, for example "csv".

    Raises
    ------
    ValueError
        If it has; the message suggests a valid name.
    """
    if path.name == "-":
        raise ValueError(
            f"{path}: results are kept in files, not written to the standard output; use -o result.{ending}."
        )
    suffix = path.suffix.lower().removeprefix(".")
    if suffix in ENDINGS and suffix != ending and suffix not in OTHER_ENDINGS.get(ending, ()):
        raise ValueError(
            f"{path}: this is not a .{ending} file by its name; use -o {path.with_suffix('.' + ending)}."
        )


def refuse_place(path: Path) -> None:
    """Raise an error, before any work, if no file can be written at a path.

    Raises
    ------
    ValueError
    """
    if path.is_dir():
        raise ValueError(f"{path}: cannot be written: this is a folder; give the name of a file.")
    if not path.parent.is_dir():
        raise ValueError(
            f"{path}: there is no folder {str(path.parent)!r}; make it first, or choose another place."
        )


def is_database(path: str | Path) -> bool:
    """Whether a file begins like an SQLite database."""
    try:
        with Path(path).open("rb") as file:
            return file.read(16) == b"SQLite format 3\x00"
    except OSError:
        return False
