"""A census: many starts at one value of the parameter, and the motions that they reach."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from ..graph.contents import Attractor
from ..graph.run import Run
from ..shared.motions import Motion
from .population import Population

if TYPE_CHECKING:
    from ..journal import Journal
    from ..problems.protocol import Problem


@dataclass
class Counted:
    """A motion that a census has met, ready to be joined to a graph; `state` lies on it."""

    attractor: Attractor
    problem: Problem | None
    u: np.ndarray | None
    state: np.ndarray | None = None


def census(population: Population, p: float, count: int, seed: int, journal: Journal) -> list[Counted]:
    """Draw starts, let them settle, count; what the journal remembers is not simulated again.

    Parameters
    ----------
    population : Population
    p : float
    count, seed : int
    journal : Journal
    """
    return _settled(
        population, p, lambda: population.starts(count, seed, p), f"census/{p!r}/{count}/{seed}", journal
    )


def followed(
    population: Population, p: float, starts: np.ndarray, key: str, journal: Journal
) -> list[Counted]:
    """Let starts settle that were not drawn: what they reach has no share.

    Parameters
    ----------
    population : Population
    p : float
    starts : float array (m, n)
    key : str
        Under which the journal remembers it.
    journal : Journal
    """
    found = _settled(population, p, lambda: starts, key, journal)
    for counted in found:
        counted.attractor = replace(counted.attractor, share=0.0, mirror_share=0.0, starts=0)
    return found


def locate(run: Run, counted: Counted) -> str | None:
    """Label of the branch of the graph on which an attractor lies, exactly; None if it lies on none."""
    if counted.problem is None:
        return None
    known = run.register.find(counted.problem, np.asarray(counted.u), counted.attractor.value)
    return None if known is None else known.label


def _settled(
    population: Population, p: float, starts_of: Callable[[], np.ndarray], key: str, journal: Journal
) -> list[Counted]:
    """What starts settle on, with shares of them; the starts are made where the journal does not know."""
    known = journal.recall(key)
    recalled = None if known is None else _recalled(population, known, p)
    if known is not None and recalled is not None:
        population.work += float(known.get("work", 0.0))
        return recalled
    starts, before = starts_of(), population.work
    motions, index, mirrored = population.settle(starts, p)
    attractors = attractors_of(motions, index, mirrored, p)
    found = [Counted(a, m.problem, m.u, m.state) for a, m in zip(attractors, motions, strict=True)]
    work = population.work - before
    journal.record(key, {**_recorded(found), "work": work})
    return found


def attractors_of(
    motions: Sequence[Motion[Problem]], index: np.ndarray, mirrored: np.ndarray, p: float
) -> list[Attractor]:
    """What starts have settled on, with shares of them; see `contvines.coexistence.population`."""
    return [
        Attractor(
            float(p), m.word, int(m.periods), m.kind, None, float((index == k).mean()),
            float(((index == k) & mirrored).mean()), index.size, float(m.exponent), float(m.error),
        )
        for k, m in enumerate(motions)
    ]  # fmt: skip


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
        if counted.state is not None:
            record[f"state{k}"] = np.asarray(counted.state, dtype=float)
    return record


def _recalled(population: Population, known: dict[str, Any], p: float) -> list[Counted] | None:
    """What was recorded; None where a problem takes functions of the user's that are not at hand."""
    found = []
    for k, description in enumerate(known["problems"]):
        attractor = Attractor(
            float(p), known["word"][k], known["periods"][k], known["kind"][k], None, float(known["share"][k]),
            float(known["mirror_share"][k]), known["starts"][k], float(known["exponent"][k]), float(known["error"][k]),
        )  # fmt: skip
        u = known.get(f"u{k}")
        problem = None if description is None or u is None else population.restored(description, u, p)
        if description is not None and problem is None:
            return None
        found.append(Counted(attractor, problem, u, known.get(f"state{k}")))
    return found
