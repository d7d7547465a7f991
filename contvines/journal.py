"""Journal: what a run has already computed, so that an interrupted run can be run again and catch up."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any, Protocol

import numpy as np


class Kept(Protocol):
    """A graph or a chart, as a journal keeps it."""

    finished: bool

    @property
    def stopped(self) -> bool:
        """Whether a run with a larger budget may still go on from what the journal has."""
        ...

    def entries(self) -> Iterable[tuple[str, str, dict[str, Any]]]:
        """Everything as (kind, key, content); content holds arrays and JSON values by name."""
        ...


class Journal(Protocol):
    """The contract of a journal.

    The automatic diagram is deterministic. It asks ``recall`` before each chunk of points, each location and each
    crossing, computes only what is not there, and hands it to ``record``. Running again with the same journal
    therefore resumes.
    """

    def recall(self, key: str) -> dict[str, Any] | None:
        """What was recorded under the key: numpy arrays and JSON scalars, lists and dicts; None if nothing."""
        ...

    def record(self, key: str, values: dict[str, Any]) -> None:
        """Keep the values, as copies but of arrays that nobody can write to; on return they survive a kill."""
        ...

    def checkpoint(self, graph: Kept) -> None:
        """Called with the graph so far, after each finished branch and at the end (``graph.finished``): what is recorded is of no use then, unless
        ``graph.stopped``."""
        ...


def checked(journal: Journal) -> Journal:
    """The journal, if it has the methods of the contract.

    Raises
    ------
    ValueError
        If it has not.
    """
    missing = [
        name for name in ("recall", "record", "checkpoint") if not callable(getattr(journal, name, None))
    ]
    if missing:
        raise ValueError(
            f"journal = {journal!r} has no method {missing[0]!r}; an object with recall, record and checkpoint is asked for, "
            'such as contvines.resume("FILE.vines")'
        )
    return journal


class NullJournal:
    """A ``contvines.journal.Journal`` that keeps nothing."""

    def recall(self, key: str) -> dict[str, Any] | None:
        return None

    def record(self, key: str, values: dict[str, Any]) -> None:
        return None

    def checkpoint(self, graph: Kept) -> None:
        return None


class Part:
    """A part of a journal, for a run inside another one: its keys begin with a prefix, its graph is not kept.

    Parameters
    ----------
    journal : Journal
    prefix : str
    """

    def __init__(self, journal: Journal, prefix: str) -> None:
        self.journal, self.prefix = journal, prefix

    def recall(self, key: str) -> dict[str, Any] | None:
        return self.journal.recall(self.prefix + key)

    def record(self, key: str, values: dict[str, Any]) -> None:
        self.journal.record(self.prefix + key, values)

    def checkpoint(self, graph: Kept) -> None:
        return None


class MemoryJournal:
    """A ``contvines.journal.Journal`` in memory, for interactive work: given to the same call again, an interrupted run goes on."""

    def __init__(self) -> None:
        self.entries: dict[str, dict[str, Any]] = {}
        self.graph: object = None

    def recall(self, key: str) -> dict[str, Any] | None:
        return self.entries.get(key)

    def record(self, key: str, values: dict[str, Any]) -> None:
        self.entries[key] = {
            name: value.copy() if isinstance(value, np.ndarray) and value.flags.writeable else value
            for name, value in values.items()
        }

    def checkpoint(self, graph: Kept) -> None:
        self.graph = graph
