"""How a simulated motion of a declared machine changes with its beginning and with one of its numbers, from event to event.

With node i = (c_i, x_i), the clock and the states just after event i, and y the states at the end of the flight (`orbits.flows.page.flights`),

    dy = dy/dx (dx_i - F(x_i) dc_i) + F(y) dc + dy/dp dp,    dg = g_y dy + g_c dc + g_p dp = 0,

the second of which gives dc, the change of the event's clock; then dx_{i+1} = J_y dy + J_c dc + J_p dp. So go the saltation matrices of Aizerman
and Gantmakher, Quarterly Journal of Mechanics and Applied Mathematics 11 (1958) 243. Of a self-excited machine the clock begins anew at each
event: dc_i = 0.
"""

from __future__ import annotations

import numpy as np

from orbits.contacts.letters import HIT, HOLD, RELEASE, Letter
from orbits.flows.page.stepper import Stepper


class Variations:
    """Derivatives that go along with a stepper.

    Parameters
    ----------
    stepper : Stepper
        Where the motion begins, at a given clock.
    index : int
        The number by which to differentiate: a parameter's place.
    """

    def __init__(self, stepper: Stepper, index: int) -> None:
        n = stepper.machine.size
        self.stepper, self.active = stepper, (index,)
        self._states = np.hstack(
            [np.eye(n), np.zeros((n, 1))]
        )  # of the node, by the beginning and the number
        self._clock = np.zeros(n + 1)
        self._row = np.empty(n + n * (n + 1))
        self._known = True

    @property
    def derivatives(self) -> tuple[np.ndarray, np.ndarray]:
        """Of the states now, by those at the beginning, shape (n, n), and by the number, shape (n,); NaN after a wall has held."""
        found = self._states if self._known else np.full_like(self._states, np.nan)
        return found[:, :-1].copy(), found[:, -1].copy()

    def advance(self, until: float) -> tuple[int, int, int] | None:
        """`Stepper.advance`, and the derivatives with it."""
        stepper = self.stepper
        state, modes = stepper.state.copy(), stepper.modes
        begin, since = stepper.clock, stepper.base + stepper.clock
        event = stepper.advance(until)
        if not self._known:
            return event
        if event is not None and event[1] in (HOLD, RELEASE):
            self._known = False
            return event
        end = begin + (stepper.base + stepper.clock - since)
        self._pass(state, modes, begin, end, event)
        return event

    def _pass(
        self,
        state: np.ndarray,
        modes: tuple[int, ...],
        begin: float,
        end: float,
        event: tuple[int, int, int] | None,
    ) -> None:
        stepper, n = self.stepper, len(state)
        compiled, forced = stepper.compiled, stepper.machine.forced
        key = stepper.equations.pattern_key(modes)
        numbers = compiled.numbers(stepper.params, modes)
        if not compiled.flight(key, self.active)(state, begin, end, numbers, self._row):
            self._known = False
            return
        arrival, sensitivity = self._row[:n], self._row[n:].reshape(n, n + 1)
        rates = compiled.rates(key)
        moved = self._states
        if forced:
            moved = moved - np.outer(rates.one(state, begin, numbers), self._clock)
        change = sensitivity[:, :n] @ moved  # of the arrival, at a fixed clock
        change[:, -1] += sensitivity[:, n]
        if event is None:
            self._states = change
            return
        contact, kind, sign = event
        table = compiled.event(Letter("", contact, kind), sign, key, self.active)
        rows = table.one(arrival, end, numbers).reshape(-1, n + 3)  # value, by states, clock and number
        speed = rates.one(arrival, end, numbers)
        slopes = rows[0, 1 : n + 1]
        with np.errstate(all="ignore"):
            clock = -(slopes @ change) / (slopes @ speed + rows[0, n + 1])
            clock[-1] -= rows[0, n + 2] / (slopes @ speed + rows[0, n + 1])
        change = change + np.outer(speed, clock)
        if kind == HIT:
            change = rows[1:, 1 : n + 1] @ change + np.outer(rows[1:, n + 1], clock)
            change[:, -1] += rows[1:, n + 2]
        self._states, self._clock = change, clock if forced else np.zeros(n + 1)
