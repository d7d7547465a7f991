"""One SQLite file per study: a journal that lets a killed run go on, and the finished graph.

The file is written in write-ahead mode, one transaction per journal record. A file that is not ours, is
damaged, is newer, or belongs to another study is refused with a sentence and left untouched.
"""

from typing import TYPE_CHECKING

from contvines.shared.on_demand import on_demand

if TYPE_CHECKING:
    from .database import Store
    from .files import load, resume, save
    from .on_disk import APPLICATION_ID, VERSION, StoreError, printable

__all__ = ["APPLICATION_ID", "VERSION", "Store", "StoreError", "load", "printable", "resume", "save"]

__getattr__ = on_demand(
    __name__,
    {
        "Store": "contvines.store.database",
        **dict.fromkeys(("load", "resume", "save"), "contvines.store.files"),
        **dict.fromkeys(("APPLICATION_ID", "VERSION", "StoreError", "printable"), "contvines.store.on_disk"),
    },
)
