"""Endings of names: a file must not claim to hold what it does not."""

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
