"""What a run has already computed: the journal, by which an interrupted one catches up, the result that it leaves, and with what it was made."""

from __future__ import annotations

import json
import platform
from collections.abc import Callable, Iterable, Mapping
from datetime import UTC, datetime
from importlib.metadata import PackageNotFoundError, version
from types import MappingProxyType
from typing import Any, Protocol

import numpy as np

from .core.library import variant


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


class Resumable:
    """A result that interrupted work may leave.

    Attributes
    ----------
    rest : callable or None
        Goes on with the interrupted work, from what is done, and returns the whole result; None where nothing was interrupted,
        and in results from files.
    origin : mapping
        Of a result from a file: the ``study`` that the file keeps, seeds included, and with what it was ``made``.
    """

    rest: Callable[[], Any] | None = None
    origin: Mapping[str, Any] = MappingProxyType({})

    @property
    def stopped(self) -> bool:
        """Whether a budget is used up: with a larger one the same call goes on."""
        return False


class Interrupted(KeyboardInterrupt):
    """Raised when Ctrl-C stops a long computation.

    Attributes
    ----------
    graph : Graph, Chart or Survey
        All that is done; ``contvines.resume(graph)`` goes on.
    """

    def __init__(self, graph: Resumable) -> None:
        super().__init__(
            f"interrupted: all that is done is in .graph, {graph!r}; contvines.resume(that graph) goes on"
        )
        self.graph = graph


def unfinished(result: Resumable, rest: Callable[[], Any]) -> None:
    """Say how interrupted work goes on; a result may be frozen."""
    object.__setattr__(result, "rest", rest)


PACKAGES = ("contvines", "numpy", "scipy")


def version_of(package: str) -> str | None:
    """The installed version of a package; None where it is not installed."""
    try:
        return version(package)
    except PackageNotFoundError:
        return None


def provenance() -> dict[str, str]:
    """Versions of contvines, numpy, scipy and Python, the platform, the core that computes, and the date in UTC.

    Returns
    -------
    dict of str to str
        Keys ``contvines``, ``numpy``, ``scipy``, ``python``, ``platform``, ``core`` and ``date`` (ISO 8601, to the second).
    """
    found = {name: version_of(name) or "unknown" for name in PACKAGES}
    return {
        **found,
        "python": platform.python_version(),
        "platform": f"{platform.system()} {platform.machine()}",
        "core": variant(),
        "date": datetime.now(UTC).isoformat(timespec="seconds"),
    }


def carried(result: Resumable) -> dict[str, Any]:
    """What an export of a result says of its making: ``made``, of a result from a file as the file has it, ``settings``, and the ``study``, where the file keeps one."""
    about = {"made": result.origin.get("made") or provenance(), "settings": getattr(result, "settings", {})}
    study = result.origin.get("study")
    return {**about, "study": study} if study else about


def comments(result: Resumable) -> list[str]:
    """`carried` in lines of comments for people: with what it was made, and the study."""
    about = carried(result)
    study = about.get("study") or {}
    source = study.get("source") or {}
    said = source.get("text") or json.dumps(study)
    named = f"contvines {source.get('command', '')} {source.get('study', '')}".rstrip()
    return [as_text(about["made"]), *([f"{named}, the study:", *said.splitlines()] if study else [])]


def as_text(made: dict[str, str]) -> str:
    """One line for people; empty for a file that does not say with what it was made."""
    if not made:
        return ""
    return (
        f"made {made.get('date', '')} with contvines {made.get('contvines', '?')}, numpy {made.get('numpy', '?')}, "
        f"scipy {made.get('scipy', '?')}, Python {made.get('python', '?')}, {made.get('core', '?')} core, {made.get('platform', '?')}"
    )
