"""Journals of long computations, from which interrupted runs resume; unfinished results; versions of the software that made a result."""

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
    """Protocol of a result that a journal stores: a graph or a chart."""

    finished: bool

    @property
    def stopped(self) -> bool:
        """Whether a budget stopped the run, so that a run with a larger budget can continue from the journal."""
        ...

    def entries(self) -> Iterable[tuple[str, str, dict[str, Any]]]:
        """Yield all parts of the result as (kind, key, content); content maps names to arrays and JSON values."""
        ...


class Journal(Protocol):
    """Protocol of a journal: a store of intermediate results by key.

    The automatic diagram is deterministic. Before each chunk of points, each location of a special point and each
    switch of branches it calls ``recall``; it computes only missing results and passes them to ``record``. The same
    call with the same journal therefore resumes an interrupted run.
    """

    def recall(self, key: str) -> dict[str, Any] | None:
        """Return the values recorded under a key (numpy arrays and JSON scalars, lists and dicts); None if there are none."""
        ...

    def record(self, key: str, values: dict[str, Any]) -> None:
        """Store values under a key.

        Writeable arrays must be copied. A journal on disk must have stored the values durably when this returns: a killed
        process may not lose them.
        """
        ...

    def checkpoint(self, graph: Kept) -> None:
        """Store the graph so far; called after each finished branch and at the end.

        Once ``graph.finished`` is true the recorded values may be deleted, unless ``graph.stopped``.
        """
        ...


def checked(journal: Journal) -> Journal:
    """Return the journal after checking that it has the methods of `Journal`.

    Raises
    ------
    ValueError
        If a method is missing.
    """
    missing = [
        name for name in ("recall", "record", "checkpoint") if not callable(getattr(journal, name, None))
    ]
    if missing:
        raise ValueError(
            f"journal = {journal!r} has no method {missing[0]!r}; give an object with recall, record and checkpoint, "
            'such as contvines.resume("FILE.vines")'
        )
    return journal


class NullJournal:
    """A ``contvines.journal.Journal`` that stores nothing."""

    def recall(self, key: str) -> dict[str, Any] | None:
        return None

    def record(self, key: str, values: dict[str, Any]) -> None:
        return None

    def checkpoint(self, graph: Kept) -> None:
        return None


class Part:
    """Journal of a run inside another run: it stores in the outer run's journal under prefixed keys, and does not store its graph.

    Parameters
    ----------
    journal : Journal
        Journal of the outer run.
    prefix : str
        Put before each key.
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
    """A ``contvines.journal.Journal`` in memory, for interactive work: the same call with the same journal resumes an interrupted run."""

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
    """Base class of results whose computation may be interrupted and resumed.

    Attributes
    ----------
    rest : callable or None
        Resumes the interrupted computation and returns the complete result; None if it was not interrupted, and for
        results loaded from files.
    origin : mapping
        For a result loaded from a file: the ``study`` stored in the file, seeds included, and the versions that ``made``
        it (see `provenance`). Empty otherwise.
    """

    rest: Callable[[], Any] | None = None
    origin: Mapping[str, Any] = MappingProxyType({})

    @property
    def stopped(self) -> bool:
        """Whether a budget stopped the computation; the same call with a larger budget continues it."""
        return False


class Interrupted(KeyboardInterrupt):
    """Raised when Ctrl-C stops a long computation.

    Attributes
    ----------
    graph : Graph, Chart or Survey
        The partial result; ``contvines.resume(graph)`` continues the computation.
    """

    def __init__(self, graph: Resumable) -> None:
        super().__init__(
            f"interrupted: all that is done is in .graph, {graph!r}; contvines.resume(that graph) goes on"
        )
        self.graph = graph


def unfinished(result: Resumable, rest: Callable[[], Any]) -> None:
    """Set the callable that resumes the computation of a result, ``result.rest``, also on a frozen dataclass."""
    object.__setattr__(result, "rest", rest)


PACKAGES = ("contvines", "numpy", "scipy")


def version_of(package: str) -> str | None:
    """Return the installed version of a package; None if it is not installed."""
    try:
        return version(package)
    except PackageNotFoundError:
        return None


def provenance() -> dict[str, str]:
    """Return the versions of contvines, numpy, scipy and Python, the platform, the kind of compiled core, and the date in UTC.

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
    """Return the metadata that exports of a result contain.

    Returns
    -------
    dict
        ``made``: the provenance stored in the result's file, otherwise that of this process; ``settings``; and ``study`` if the
        result's file contains one.
    """
    data = {"made": result.origin.get("made") or provenance(), "settings": getattr(result, "settings", {})}
    study = result.origin.get("study")
    return {**data, "study": study} if study else data


def comments(result: Resumable) -> list[str]:
    """Return the metadata of `carried` as readable comment lines: provenance, then the study's text."""
    data = carried(result)
    study = data.get("study") or {}
    source = study.get("source") or {}
    text = source.get("text") or json.dumps(study)
    named = f"contvines {source.get('command', '')} {source.get('study', '')}".rstrip()
    return [as_text(data["made"]), *([f"{named}, the study:", *text.splitlines()] if study else [])]


def as_text(origin: dict[str, str]) -> str:
    """Format the result of `provenance` as one line; an empty string for an empty dict."""
    if not origin:
        return ""
    return (
        f"made {origin.get('date', '')} with contvines {origin.get('contvines', '?')}, numpy {origin.get('numpy', '?')}, "
        f"scipy {origin.get('scipy', '?')}, Python {origin.get('python', '?')}, {origin.get('core', '?')} core, {origin.get('platform', '?')}"
    )
