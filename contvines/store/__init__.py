"""Files (.vines): one SQLite database per study, with the journal from which a killed run resumes, and the graph.

The database is written in write-ahead mode, one transaction per journal record. A file that another program made, that is
damaged, newer, or belongs to another study raises `StoreError` and is left untouched.
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
