"""Names of files: where one can be written, and that it does not claim to hold what it does not."""

from pathlib import Path

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
