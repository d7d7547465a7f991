"""One SQLite file per study: a journal that lets a killed run go on, and the finished graph.

The file is written in write-ahead mode, one transaction per journal record. A file that is not ours, is
damaged, is newer, or belongs to another study is refused with a sentence and left untouched.
"""

from .database import Store
from .files import load, resume, save
from .header import APPLICATION_ID, VERSION, StoreError
from .packing import printable

__all__ = ["APPLICATION_ID", "VERSION", "Store", "StoreError", "load", "printable", "resume", "save"]
