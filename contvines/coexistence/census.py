"""A census: many starts at one value of the parameter, and the motions that they reach."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from ..graph.attractor import Attractor
from ..problems.registry import rebuild
from .population import Population


@dataclass
class Counted:
    """A motion that a census has met, ready to be joined to a graph."""

    attractor: Attractor
    problem: Any
    u: np.ndarray | None


def census(
    population: Population, p: float, count: int, seed: int, journal: Any, extra: np.ndarray | None = None
) -> list[Counted]:
    """Draw starts, let them settle, count; what the journal remembers is not simulated again.

    Parameters
    ----------
    population : Population
    p : float
    count, seed : int
    journal : Journal
    extra : float array (m, n), optional
        Starts beside the drawn ones.
    """
    key = f"census/{p!r}/{count}/{seed}"
    known = journal.recall(key)
    if known is not None and all(entry is None or entry.get("factory") for entry in known["problems"]):
        return _recalled(known, p)
    starts = population.starts(count, seed, p)
    if extra is not None:
        starts = np.concatenate([starts, extra])
    motions, index, mirrored = population.settle(starts, p)
    found = []
    for k, motion in enumerate(motions):
        here = index == k
        attractor = Attractor(
            float(p),
            motion.word,
            int(motion.periods),
            motion.kind,
            None,
            float(here.mean()),
            float((here & mirrored).mean()),
            len(starts),
            float(motion.exponent),
            float(motion.error),
        )
        found.append(Counted(attractor, motion.problem, motion.u))
    journal.record(key, _recorded(found))
    return found


def _recorded(found: Sequence[Counted]) -> dict[str, Any]:
    record: dict[str, Any] = {
        "problems": [None if c.problem is None else dict(c.problem.describe()) for c in found],
        "word": [c.attractor.word for c in found],
        "kind": [c.attractor.kind for c in found],
        "periods": [c.attractor.periods for c in found],
        "starts": [c.attractor.starts for c in found],
    }
    for name in ("share", "mirror_share", "exponent", "error"):
        record[name] = np.array([getattr(c.attractor, name) for c in found])
    for k, counted in enumerate(found):
        if counted.u is not None:
            record[f"u{k}"] = np.asarray(counted.u, dtype=float)
    return record


def _recalled(known: dict[str, Any], p: float) -> list[Counted]:
    found = []
    for k, description in enumerate(known["problems"]):
        attractor = Attractor(
            float(p), known["word"][k], known["periods"][k], known["kind"][k], None, float(known["share"][k]),
            float(known["mirror_share"][k]), known["starts"][k], float(known["exponent"][k]), float(known["error"][k]),
        )  # fmt: skip
        problem = None if description is None else rebuild(description)
        found.append(Counted(attractor, problem, known.get(f"u{k}")))
    return found
