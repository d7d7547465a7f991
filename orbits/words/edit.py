"""A change of a word with the nodes of its new events, of built-in and declared machines."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from orbits.contacts.changes import Change
from orbits.contacts.letters import HIT
from orbits.words.rewriting import later


class Edit(NamedTuple):
    """A change of the word, and the nodes of its new events, a row each: phase or clock first, then what is held there."""

    change: Change
    nodes: np.ndarray

    def later(self, rounds: int, problem: Any, p: float) -> Edit:
        """The same some rounds later, in a longer cycle; a round is a cycle of the problem, or half a symmetric one."""
        if rounds == 0:
            return self
        turned = problem.symmetric and rounds % 2 == 1
        nodes = -self.nodes if turned else self.nodes.copy()
        nodes[:, 0] = self.nodes[:, 0] + rounds * problem.shift
        if turned and (middle := problem.middle(p)):  # images are taken about the middle between the walls
            letters = problem.word.alphabet.letters
            nodes[[letters[text].kind != HIT for text in self.change.events], 1] += 2.0 * middle
        return Edit(later(self.change, rounds * problem.length, problem.word.alphabet, turned), nodes)
