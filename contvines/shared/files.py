"""Files: where one can be written under which name, tables as CSV, Python files that a user names, and digests that tell runs apart."""

from __future__ import annotations

import csv
import hashlib
import json
import sys
from collections.abc import Iterable
from importlib.util import module_from_spec, spec_from_file_location
from pathlib import Path
from types import ModuleType

KNOWN = (
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
ALSO = {"csv": ("txt",)}  # endings that fit beside the usual one


def write_csv(path: str | Path, head: Iterable[str], rows: Iterable[Iterable[object]]) -> None:
    """A line of heads, then one for each row; an OSError where the file cannot be written."""
    with Path(path).open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file)
        writer.writerow(head)
        writer.writerows(rows)


def digest_of(data: object) -> str:
    """The same for equal data, ready for JSON; in files since version 0.1, so that it stays what it is."""
    return hashlib.sha256(json.dumps(data, sort_keys=True, default=str).encode()).hexdigest()


def module_of(path: str | Path) -> ModuleType:
    """The module that a Python file makes when it is run, once in a process as long as its text stays.

    Only for a file that the user has named.

    Raises
    ------
    OSError
        If it cannot be read.
    ValueError
        If it is no Python file, or does not run.
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
    """Under which names a module has things of a kind."""
    return [name for name, value in vars(module).items() if isinstance(value, kind)]


def refuse_ending(path: Path, ending: str) -> None:
    """Refuse a name whose ending is that of another kind of file; no ending and unknown ones are allowed.

    Parameters
    ----------
    path : Path
        Where something is to be written.
    ending : str
        What will be written, for example "csv".

    Raises
    ------
    ValueError
        With a sentence that names the file and a valid name.
    """
    if path.name == "-":
        raise ValueError(
            f"{path}: results are kept in files, not written to the standard output; use -o result.{ending}."
        )
    own = path.suffix.lower().removeprefix(".")
    if own in KNOWN and own != ending and own not in ALSO.get(ending, ()):
        raise ValueError(
            f"{path}: this is not a .{ending} file by its name; use -o {path.with_suffix('.' + ending)}."
        )


def refuse_place(path: Path) -> None:
    """Refuse, before any work, a place at which no file can be.

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
    """Whether a file starts like a SQLite database."""
    try:
        with Path(path).open("rb") as file:
            return file.read(16) == b"SQLite format 3\x00"
    except OSError:
        return False
