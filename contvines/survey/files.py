"""A survey's NetCDF file, with a digest of all its bytes: a damaged file is refused.

The digest is an attribute of the file. It is worked out, and checked, with zeros in its own place.
"""

from __future__ import annotations

import hashlib
import io
import os
from pathlib import Path
from typing import TYPE_CHECKING

from ..shared.on_demand import needed
from .plan import PlanError

if TYPE_CHECKING:
    from xarray import Dataset


FORMAT = "contvines survey 2"  # the first had no digest
BLANK = b"0" * 64
MARK = b"sha256\0\0" + (2).to_bytes(4, "big") + len(BLANK).to_bytes(4, "big")
"""How the attribute begins in the file: its name, that it is text, and how long (NetCDF classic format, section on attributes)."""


def write(data: Dataset, path: Path) -> None:
    """Write a data set with its digest; a file of that name is replaced in one step.

    Parameters
    ----------
    data : xarray.Dataset
    path : Path
    """
    draft = path.with_name(path.name + ".new")
    marked = data.assign_attrs(format=FORMAT, sha256=BLANK.decode())
    marked.to_netcdf(draft, engine="scipy", format="NETCDF3_64BIT")  # needs no library of its own
    content = draft.read_bytes()
    place = content.index(MARK) + len(MARK)
    digest = hashlib.sha256(content).hexdigest().encode()
    draft.write_bytes(content[:place] + digest + content[place + len(BLANK) :])
    os.replace(draft, path)


def read(path: Path) -> Dataset:
    """The data set of a file, in memory.

    Raises
    ------
    PlanError
        If there is no such file, it is not the file of a survey, or it is damaged.
    """
    xarray = needed("xarray", "tables")

    try:
        content = path.read_bytes()
    except FileNotFoundError:
        raise PlanError(f"{path}: there is no such file") from None
    except OSError as error:
        raise PlanError(f"{path}: this file cannot be read ({error.strerror})") from None
    if not _sound(content):
        raise PlanError(
            f"{path}: this file is damaged, it has changed since it was written; move it away, and the survey makes it again"
        )
    try:
        with xarray.open_dataset(io.BytesIO(content), engine="scipy") as data:
            data.load()
    except (
        Exception
    ):  # of another kind, or one without a digest that is damaged: whatever its reader stumbles over
        raise PlanError(f"{path}: this is not the NetCDF file of a survey, or it is damaged") from None
    return data


def _sound(content: bytes) -> bool:
    """Whether the digest is that of the content; files of the first format have none."""
    before, mark, after = content.partition(MARK)
    if not mark:
        return FORMAT.encode() not in content
    kept, rest = after[: len(BLANK)], after[len(BLANK) :]
    return hashlib.sha256(before + mark + BLANK + rest).hexdigest().encode() == kept
