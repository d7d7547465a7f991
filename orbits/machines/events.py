"""What happens at the events of a motion: positions and velocities from its nodes, for many solutions at once."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np

from orbits.machines.base import Model
from orbits.machines.varying import Varying
from orbits.words import Word
from orbits.words.alphabet import CODES

LEFT_IMPACT, RIGHT_IMPACT = CODES["L"], CODES["R"]  # 0 and 1, before all others


@dataclass(frozen=True)
class EventTable:
    """What happens at each event; all arrays have shape (m, L).

    Attributes
    ----------
    phase : float array
        Psi, radians from the start of the forcing.
    w, rate_post, rate_pre : float array
        Relative position, relative velocity after and before the event.
    B_post, B_pre : float array
        Absolute velocity of the absorber times 1 + eps, v' - w', after and before the event.
    v, v_rate : float array
        Cavity coordinate v and its rate.
    """

    phase: np.ndarray
    w: np.ndarray
    rate_post: np.ndarray
    rate_pre: np.ndarray
    B_post: np.ndarray
    B_pre: np.ndarray
    v: np.ndarray
    v_rate: np.ndarray


def event_table(model: Model, word: Word, nodes: np.ndarray, params: np.ndarray) -> EventTable:
    """Positions and velocities at all events, from nodes (m, L, n) and parameter vectors (m, P)."""
    phase = nodes[:, :, 0]
    v, v_rate = model.cavity_motion(nodes, params)
    hits, walls, r = contacts(model, word, params)
    w = np.where(hits, walls, nodes[:, :, 1])
    rate_post = np.where(hits, v_rate - nodes[:, :, 1], 0.0)
    rate_pre = np.where(hits, -rate_post / r, 0.0)
    return EventTable(phase, w, rate_post, rate_pre, v_rate - rate_post, v_rate - rate_pre, v, v_rate)


def contacts(model: Model, word: Word, params: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Which events are impacts, shape (L,), and their walls' places and coefficients of restitution, shape (m, L)."""
    codes = word.codes
    left, hits = codes == LEFT_IMPACT, codes <= RIGHT_IMPACT
    (at_left, at_right), (by_left, by_right) = model.walls(params), model.restitutions(params)
    walls = np.where(left, at_left[:, None], at_right[:, None])
    return hits, walls, np.where(left, by_left[:, None], by_right[:, None])


class Placed(Protocol):
    """A motion with its nodes, shape (L, n), and its parameters."""

    @property
    def model(self) -> Varying: ...
    @property
    def word(self) -> Word: ...
    @property
    def nodes(self) -> np.ndarray: ...
    @property
    def params(self) -> np.ndarray: ...


def events_of(motion: Placed) -> EventTable:
    """What happens at the events of one motion (its model, word, nodes and params); arrays of shape (L,).

    Raises
    ------
    AttributeError
        If it is one of a declared machine.
    """
    model = motion.model
    if not isinstance(model, Model):
        raise AttributeError(
            f"events are of built-in machines; {model.name!r} is declared: its orbits have nodes, a row per event with the states after it, and a word"
        )
    table = event_table(model, motion.word, motion.nodes[None], motion.params[None])
    return EventTable(**{name: values[0] for name, values in vars(table).items()})
