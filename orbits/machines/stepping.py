"""What every stepper offers: state, event rows, status, and the functions of a machine.

1. *State*, float64, one vector for all models::

       index  0    1  2   3     4      5    | 6  7
              Psi  w  w'  mode  turns  low  | v  v'

   ``Psi`` is the forcing phase reduced to [0, 2 pi) and ``turns`` the number of whole forcing periods, so
   that no digit of the phase is lost in a long run. ``mode`` is -1, 0 or +1. ``w + low`` is the position:
   ``low`` keeps the digits of ``w`` below roundoff, so that a turn 1e-18 away from a wall stays there.
   A machine whose cavity moves as prescribed uses the first six entries, one with ``moving_cavity`` all eight.
   ``mode == 0`` with ``abs(w) == 1`` exactly is *persistent contact*: the absorber rests on the wall and can
   only leave it inwards.

2. ``launch(state, params) -> None`` reduces the phase, sets the mode from ``w'`` (and where ``w' = 0``
   from the accelerations) and clears nothing else.

3. ``advance(state, params, until, codes, modes, rows) -> (count, status)``

   moves ``state`` on, in place, until the arrays are full or ``turns + Psi/(2 pi)`` reaches ``until``, and
   writes one row per event::

       codes[i]  int8   L, R, T, S, U of :mod:`orbits.words.alphabet`, or HOLD = 5
       modes[i]  int8   mode after the event
       rows[i]   f8     0    1      2  3             4             | 5  6
                        Psi  turns  w  w' before it  w' after it   | v  v'

   HOLD ends a complete chatter: infinitely many impacts have piled up, the absorber now rests on the wall
   at ``w`` until the wall stops pushing; the release is a U event. Without friction (a = 0) turns are no
   events and no rows. Nothing is allocated, nothing is raised; the number of operations is bounded by the
   number of rows and of forcing periods.

4. ``sample(states[n, S], params, ahead[n], out[n, 4])`` writes ``w, w', v, v'`` at the phase ``ahead[i]``
   (radians, >= 0) after ``states[i]``, inside the mode of ``states[i]`` (closed form, no events).

5. ``works(states[n, S], params, ahead[n], out[n, 3])`` writes the work done inside that piece of a segment by
   the excitation (positive = into the system), the damper and the friction (positive = dissipated);
   ``energies(states[n, S], params, out[n])`` writes the energy that these works change. What an impact
   takes is the difference of the energies before and after it.

6. Constants ``STATE`` (length of the state) and ``ROW`` (length of an event row).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

HOLD = 5
"""Event code of the simulator alone: complete chatter has ended in persistent contact."""

EVENTS_FULL, TIME_REACHED, REST, FAILED = 0, 1, 2, 3
PAUSED = 4
"""Status of the native core alone: a slice of a long run is over, nothing has happened."""
STATUS: dict[int, str] = {
    EVENTS_FULL: "the requested number of events was reached",
    TIME_REACHED: "the requested time was reached",
    REST: "at rest: no event will ever happen again",
    FAILED: "the state is no longer finite",
}

PSI, W, RATE, MODE, TURNS, LOW, V, V_RATE = range(8)


@dataclass(frozen=True)
class Machine:
    """The functions of one model; see the module's docstring."""

    name: str
    state: int
    row: int
    launch: Callable
    advance: Callable
    sample: Callable
    works: Callable
    energies: Callable
    walls: Callable[[np.ndarray], tuple[Any, Any]]
    moving_cavity: bool = False

    @property
    def places(self) -> tuple[int, ...]:
        """Where a state has the coordinates of the motion at a definite phase."""
        return (W, RATE, V, V_RATE) if self.moving_cavity else (W, RATE)

    @property
    def coordinates(self) -> tuple[str, ...]:
        """Names of these: position and velocity in the cavity, then those of the centre of mass."""
        return ("w", "w_rate", "v", "v_rate")[: len(self.places)]

    @property
    def node(self) -> int:
        """Unknowns per event: the phase, and all coordinates but one, which the event fixes."""
        return len(self.places)
