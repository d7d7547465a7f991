"""Check one machine by all checks, with a time limit."""

from __future__ import annotations

import contextlib
import signal
import traceback
import warnings
from collections.abc import Iterator
from typing import Any

import numpy as np

import contvines as cv
from tools.fuzz import finer, neighbours, simulated, structure
from tools.fuzz.drawing import Draw, draw
from tools.fuzz.tally import Tally

SECONDS = 150.0  # most processor time for each part
LIMITS = {"max_branches": 80}


class TooLong(BaseException):
    """A part exceeds its time limit."""


@contextlib.contextmanager
def within_seconds(seconds: float) -> Iterator[None]:
    """Context manager: raise `TooLong` after this processor time, if the operating system supports it."""
    if not hasattr(signal, "SIGVTALRM"):
        yield
        return

    def stop(*_: Any) -> None:
        raise TooLong

    before = signal.signal(signal.SIGVTALRM, stop)
    signal.setitimer(signal.ITIMER_VIRTUAL, seconds)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_VIRTUAL, 0.0)
        signal.signal(signal.SIGVTALRM, before)


def search(kind: str, salt: int, seed: int, finely: bool = False) -> Tally:
    """Draw a machine and check it; with `finely` also by finer diagrams."""
    tally = Tally(kind, salt, seed)
    tally.count("machines")
    rng = np.random.default_rng([salt, seed])
    drawn: list[Draw] = []
    graphs: list[Any] = []
    parts = {
        "start": lambda: drawn.append(draw(kind, salt, seed)),
        "diagram": lambda: graphs.extend(_diagram(drawn[0])),
        "attractors": lambda: simulated.settle(drawn[0], tally, rng),
        "structure": lambda: [structure.judge(graph, tally) for graph in graphs],
        "neighbours": lambda: [neighbours.judge(graph, tally) for graph in graphs],
        "simulation": lambda: [simulated.judge(graph, tally, rng) for graph in graphs],
    }
    if finely:
        parts["finer"] = lambda: [finer.judge(drawn[0], graph, tally, LIMITS) for graph in graphs]
    with warnings.catch_warnings():
        warnings.simplefilter("error", RuntimeWarning)
        for name, part in parts.items():
            try:
                with within_seconds(SECONDS):
                    part()
            except TooLong:
                tally.find("time", f"{name} takes more than {SECONDS:.0f} s")
            except Exception as error:
                last = traceback.extract_tb(error.__traceback__)[-1]
                tally.find(
                    "exception", f"{name}: {type(error).__name__}: {error} ({last.filename}:{last.lineno})"
                )
            if not drawn:
                break
    tally.count("diagrams", len(graphs))
    tally.count(
        "diagrams cut at their largest number of branches", sum(not graph.complete for graph in graphs)
    )
    return tally


def _diagram(drawn: Draw) -> list[Any]:
    if drawn.orbit is None:
        return []
    return [cv.diagram(drawn.orbit, **drawn.options, settings=LIMITS)]
