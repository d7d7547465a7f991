"""What the contacts' laws propose at a border orbit, with the nodes of the new events, and the word and nodes that come of it.

The laws (`orbits.contacts`) say how the word changes and where the new events are; the flow gives them their numbers.
"""

from __future__ import annotations

import numpy as np

from orbits.contacts.changes import Spot
from orbits.orbit import Orbit
from orbits.settings import BORDERING, GROWING
from orbits.words.margins import place_of
from orbits.words.rewriting import Edit, applied, changes_at, spliced
from orbits.words.word import Word


def edits_at(orbit: Orbit, index: int, unit: int | None = None) -> list[Edit]:
    """The edits that margin `index` may ask for at the border orbit, the likeliest first.

    Parameters
    ----------
    orbit : Orbit
        The border orbit, over its whole cycle, read so that the margin's event is not the last one.
    index : int
        Index of the vanishing margin.
    unit : int, optional
        Number of events after which the cycle repeats, or mirrors, itself; default: all.
    """
    found = orbit.flow.vanishing(orbit, index, unit or len(orbit.word))
    if found is None:
        return []
    place, _ = place_of(orbit.word, index)
    changes = changes_at(found.site, found.watched)
    return [Edit(change, orbit.flow.placed(orbit, found, place, change)) for change in changes]


def rewritten(word: Word, nodes: np.ndarray, edits: list[Edit]) -> tuple[Word, np.ndarray, int]:
    """The word and nodes after the edits (of disjoint places), and where the first edit's new events stand."""
    changes = [edit.change for edit in edits]
    new, first = applied(word, changes)
    return new, spliced(nodes, changes, [edit.nodes for edit in edits], not len(word)), first


def durations_after(durations: np.ndarray, nodes: np.ndarray, edit: Edit) -> np.ndarray:
    """Nodes of a self-excited orbit after an edit, whose inserted events have clocks from the flight's start: durations in their place.

    Parameters
    ----------
    durations : ndarray, shape (L,)
        Before the edit.
    nodes : ndarray
        After it.
    edit : Edit
    """
    nodes = nodes.copy()
    change, m = edit.change, len(edit.change.events)
    if change.start == change.stop and m:  # inserted into the flight before `start`
        if len(nodes) == m:  # the first events of a motion that had none
            nodes[:, 0] = np.diff(np.append(edit.nodes[:, 0], edit.nodes[0, 0] + durations.sum()))
            return nodes
        inside = np.append(edit.nodes[:, 0], durations[change.start - 1])
        nodes[change.start - 1, 0] = inside[0]
        nodes[change.start : change.start + m, 0] = np.diff(inside)
        return nodes
    # from the event before `start` to that at `stop` it takes as long as before
    alone = len(nodes) == m  # nothing of the old word is left: the last flight leads to the first new event
    passed = np.cumsum(np.roll(durations, 1 - change.start)[: change.stop - change.start + 1])
    instants = [_instant(spot, change.start, passed) for spot in change.spots]
    whole = [*instants, instants[0] + durations.sum()] if alone else [0.0, *instants, passed[-1]]
    spans = np.maximum(np.diff(whole), BORDERING.least_flight)
    nodes[(np.arange(len(spans)) + change.start - (0 if alone else 1)) % len(nodes), 0] = spans
    return nodes


def _instant(spot: Spot, start: int, passed: np.ndarray) -> float:
    """When the event of a spot happens, `passed` after the event before `start`."""
    event = spot.node if spot.clock is None else spot.clock
    assert event is not None  # nothing is met where events give way to others
    place = event - start
    ahead = 0.5 * (passed[place + 1] - passed[place]) if spot.between else 0.0
    return float(passed[place] + ahead + spot.later * GROWING.first)
