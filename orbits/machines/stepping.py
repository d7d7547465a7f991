"""The stepper of the built-in machines: layout of states and event rows, status codes, and the functions that move states on.

1. *State*, float64, one vector for all models::

       index  0    1  2   3     4      5    | 6  7
              Psi  w  w'  mode  turns  low  | v  v'

   ``Psi`` is the forcing phase reduced to [0, 2 pi) and ``turns`` the number of whole forcing periods, so
   that the phase keeps its accuracy in long runs. ``mode`` is -1, 0 or +1. ``w + low`` is the position:
   ``low`` keeps the digits of ``w`` below roundoff, so that a turn 1e-18 away from a wall stays there.
   A machine with prescribed cavity motion uses the first six entries, one with ``moving_cavity`` all eight.
   ``mode == 0`` with ``abs(w) == 1`` exactly is *persistent contact*: the absorber rests on the wall and can
   only leave it inwards.

2. ``launch(state, params) -> None`` reduces the phase, sets the mode from ``w'`` (if ``w' = 0``
   from the accelerations) and clears nothing else.

3. ``advance(state, params, until, codes, modes, rows) -> (count, status)``

   moves ``state`` on, in place, until the arrays are full or ``turns + Psi/(2 pi)`` reaches ``until``, and
   writes one row per event::

       codes[i]  int8   L, R, T, S, U of :mod:`orbits.words.alphabet`, or HOLD = 5
       modes[i]  int8   mode after the event
       rows[i]   f8     0    1      2  3             4             | 5  6
                        Psi  turns  w  w' before it  w' after it   | v  v'

   HOLD ends a complete chatter: infinitely many impacts have accumulated, and the absorber rests on the wall
   at ``w`` until the wall stops pushing; the release is a U event. Without friction (a = 0) turns are no
   events and write no rows. The function neither allocates memory nor raises errors; the number of operations is
   bounded by the number of rows and of forcing periods.

4. ``sample(states[n, S], params, ahead[n], out[n, 4])`` writes ``w, w', v, v'`` at the phase ``ahead[i]``
   (radians, >= 0) after ``states[i]``, in the mode of ``states[i]`` (closed form, no events).

5. ``works(states[n, S], params, ahead[n], out[n, 3])`` writes the work done in the same piece of a flight by
   the excitation (positive = into the system), the damper and the friction (positive = dissipated);
   ``energies(states[n, S], params, out[n])`` writes the energy that these works change. The loss at an impact
   is the difference of the energies before and after it.

6. ``shapes(states[n, S], params, ahead[n], out[n, 4])`` writes the largest abs(q1) in the same piece of a flight, and the integrals of
   v sin Psi, v cos Psi and q1 sin Psi over the phase; only for machines with ``moving_cavity``.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import Any

import numpy as np

HOLD = 5
"""Event code that only the simulator uses: complete chatter has ended in persistent contact."""

EVENTS_FULL, TIME_REACHED, REST, FAILED = 0, 1, 2, 3
PAUSED = 4
"""Status that only the native core uses: a slice of a long run is over without further meaning."""
STATUS: dict[int, str] = {
    EVENTS_FULL: "the requested number of events was reached",
    TIME_REACHED: "the requested time was reached",
    REST: "at rest: no event will ever happen again",
    FAILED: "the state is no longer finite",
}

PSI, W, RATE, MODE, TURNS, LOW, V, V_RATE = range(8)
TWO_PI = 2.0 * np.pi


class Stepper(ABC):
    """Moves the motions of one machine on; see the module's docstring.

    Attributes
    ----------
    name : str
    moving_cavity : bool
    places : tuple of int
        Indices in a state of the coordinates of the motion.
    coordinates : tuple of str
        Their names: position and velocity in the cavity, then those of the centre of mass.
    node : int
        Unknowns per event: the phase, and all coordinates but one, which the event fixes.
    state, row : int
        Lengths of a state and of an event row.
    """

    def __init__(self, name: str, moving_cavity: bool) -> None:
        self.name, self.moving_cavity = name, moving_cavity
        self.places = (W, RATE, V, V_RATE) if moving_cavity else (W, RATE)
        self.node = len(self.places)
        self.coordinates = ("w", "w_rate", "v", "v_rate")[: self.node]
        self.state, self.row = 4 + self.node, 3 + self.node

    @abstractmethod
    def walls(self, params: np.ndarray) -> tuple[Any, Any]:
        """Return w at the left and at the right wall."""

    @abstractmethod
    def launch(self, state: np.ndarray, params: np.ndarray) -> None:
        """Reduce the phase and set the mode of a start; item 2 of the module."""

    @abstractmethod
    def advance(
        self,
        state: np.ndarray,
        params: np.ndarray,
        until: float,
        codes: np.ndarray,
        modes: np.ndarray,
        rows: np.ndarray,
    ) -> tuple[int, int]:
        """Move from event to event; item 3 of the module."""

    @abstractmethod
    def sample(self, states: np.ndarray, params: np.ndarray, ahead: np.ndarray, out: np.ndarray) -> None:
        """Write w, w', v, v' at given phases after given states; item 4 of the module."""

    @abstractmethod
    def works(self, states: np.ndarray, params: np.ndarray, ahead: np.ndarray, out: np.ndarray) -> None:
        """Write works in pieces of flights; item 5 of the module."""

    @abstractmethod
    def energies(self, states: np.ndarray, params: np.ndarray, out: np.ndarray) -> None:
        """Write energies of states; item 5 of the module."""

    @abstractmethod
    def shapes(self, states: np.ndarray, params: np.ndarray, ahead: np.ndarray, out: np.ndarray) -> None:
        """Write largest displacement and harmonics in pieces of flights; item 6 of the module."""

    # ------------------------------------------------------------------ nodes, which continuation solves for
    def states_of(
        self, params: np.ndarray, codes: np.ndarray, modes: np.ndarray, nodes: np.ndarray
    ) -> np.ndarray:
        """Return the states, shape (n, S), just after events, from their nodes (Psi, B+ or w(, v, v'))."""
        left, right = self.walls(params)
        states = np.zeros((len(nodes), self.state))
        turns = np.floor(nodes[:, 0] / TWO_PI)
        psi = nodes[:, 0] - turns * TWO_PI
        states[:, PSI] = np.where((psi >= 0.0) & (psi < TWO_PI), psi, 0.0)
        states[:, TURNS], states[:, MODE] = turns, modes
        states[:, V:] = nodes[:, 2:]
        impact = codes < 2
        states[:, W] = np.where(impact, np.where(codes == 0, left, right), nodes[:, 1])
        states[:, RATE] = np.where(impact, self._cavity_speed(params, states) - nodes[:, 1], 0.0)
        return states

    def state_of(self, params: np.ndarray, code: int, mode: int, node: np.ndarray) -> np.ndarray:
        """Return the state just after one event, shape (S,)."""
        return self.states_of(params, np.array([code]), np.array([mode]), node[None])[0]

    def event_states(self, modes: np.ndarray, rows: np.ndarray) -> np.ndarray:
        """Return the states after events, shape (n, S), from their rows."""
        states = np.zeros((len(rows), self.state))
        states[:, [PSI, TURNS, W, RATE]] = rows[:, [0, 1, 2, 4]]
        states[:, MODE], states[:, V:] = modes, rows[:, 5:]
        return states

    def nodes_of(
        self, params: np.ndarray, codes: np.ndarray, modes: np.ndarray, rows: np.ndarray
    ) -> np.ndarray:
        """Return the nodes, shape (n, NODE), of events from their rows; phases are counted through (2 pi per turn)."""
        states = self.event_states(modes, rows)
        second = np.where(codes < 2, self._cavity_speed(params, states) - states[:, RATE], states[:, W])
        return np.column_stack([states[:, PSI] + TWO_PI * states[:, TURNS], second, rows[:, 5:]])

    def _cavity_speed(self, params: np.ndarray, states: np.ndarray) -> np.ndarray:
        out = np.empty((len(states), 4))
        self.sample(states, params, np.zeros(len(states)), out)
        return out[:, 3]


def buffers(engine: Stepper, size: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return empty event arrays for `size` events."""
    return np.empty(size, np.int8), np.empty(size, np.int8), np.empty((size, engine.row))
