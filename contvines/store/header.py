"""What a .vines file looks like from outside, and which files are refused before SQLite touches them."""

import os
import struct
from pathlib import Path

APPLICATION_ID = 0x56494E45  # "VINE"
VERSION = 1
TAILS = ("-wal", "-shm", "-journal")  # of the files that SQLite keeps beside one in use
MAGIC = b"SQLite format 3\x00"


class StoreError(ValueError):
    """A file that cannot be used; the message says why and what to do. The file is left untouched."""


def check_header(path: Path, *, reading: bool = False) -> None:
    """Refuse what is not ours before SQLite touches it; `reading` if it was to be read, not to be written."""
    other = (
        "give one that `contvines diagram` or `trace` has made"
        if reading
        else "choose another name (option -o), it is left untouched"
    )
    try:
        with path.open("rb") as file:
            head = file.read(100)
    except FileNotFoundError:
        raise StoreError(
            f"{path}: there is no such file; {other}."
            if path.suffix != ".vines"
            else f"{path}: there is no such file; `contvines diagram STUDY.toml -o {path}` makes one."
        ) from None
    except OSError as error:
        raise StoreError(f"{path}: cannot be read ({error.strerror}); {other}.") from None
    if len(head) < 100 or not head.startswith(MAGIC):
        raise StoreError(f"{path}: this is not a .vines file; {other}.")
    version, application = struct.unpack(">I", head[60:64])[0], struct.unpack(">I", head[68:72])[0]
    if application != APPLICATION_ID:
        raise StoreError(f"{path}: this is a database of another program; {other}.")
    if version > VERSION:
        raise StoreError(
            f"{path}: this file has format {version}, written by a newer contvines; this one knows format {VERSION}: "
            f"update contvines, or {'give another file' if reading else 'choose another name (option -o)'}."
        )


def cut_short(path: Path) -> bool:
    """Whether a file is shorter than its header says."""
    with path.open("rb") as file:
        head = file.read(100)
        size = os.fstat(file.fileno()).st_size
    page = struct.unpack(">H", head[16:18])[0] or 512
    page = 65536 if page == 1 else page
    return not pending(path) and (size % page != 0 or size < page * struct.unpack(">I", head[28:32])[0])


def damaged(path: Path, why: str) -> StoreError:
    """The error of a file that is damaged; the logs beside it, which SQLite would take for those of the next file, are named, too."""
    logs = [path.name + tail for tail in TAILS if path.with_name(path.name + tail).exists()]
    beside = f" and with it {' and '.join(logs)}" if logs else ""
    return StoreError(f"{path}: this file is damaged ({why}); move it away{beside}, and run again.")


def pending(path: Path) -> bool:
    """Whether a live or killed run has left a log from which SQLite completes the file."""
    log = path.with_name(path.name + "-wal")
    return log.exists() and log.stat().st_size > 0
