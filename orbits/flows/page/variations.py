"""Derivatives of a simulated motion of a declared machine by its start and one parameter, and its Lyapunov exponent.

With node i = (c_i, x_i), the clock and the states just after event i, and y the states at the end of the flight
(`orbits.flows.page.cycle_equations`),

    dy = dy/dx (dx_i - F(x_i) dc_i) + F(y) dc + dy/dp dp,    dg = g_y dy + g_c dc + g_p dp = 0.

The second equation gives dc, the change of the event's clock; then dx_{i+1} = J_y dy + J_c dc + J_p dp. These are the saltation matrices
of Aizerman and Gantmakher, Quarterly Journal of Mechanics and Applied Mathematics 11 (1958) 243. The clock of a self-excited machine
restarts at each event: dc_i = 0.
"""

from __future__ import annotations

import math

import numpy as np

from contvines.shared.motions import mean_of_blocks
from orbits.arguments import SMALLEST
from orbits.contacts import HIT, HOLD, RELEASE, Letter
from orbits.flows.page.stepper import TWO_PI, Stepper
from orbits.settings import SIMULATING


class Variations:
    """Derivatives of the states of a stepper, advanced together with it.

    Parameters
    ----------
    stepper : Stepper
        At the beginning of the motion, at a given clock.
    index : int
        Place of the parameter by which to differentiate.
    """

    def __init__(self, stepper: Stepper, index: int) -> None:
        n = stepper.machine.size
        self.stepper, self.active = stepper, (index,)
        self._states = np.hstack(
            [np.eye(n), np.zeros((n, 1))]
        )  # derivatives of the node's states by the start and the parameter
        self._clock = np.zeros(n + 1)
        self._row = np.empty(n + n * (n + 1))
        self._valid = True

    @property
    def derivatives(self) -> tuple[np.ndarray, np.ndarray]:
        """Derivatives of the present states by those at the beginning, shape (n, n), and by the parameter, shape (n,); NaN after a wall has held."""
        found = self._states if self._valid else np.full_like(self._states, np.nan)
        return found[:, :-1].copy(), found[:, -1].copy()

    def advance(self, until: float) -> tuple[int, int, int] | None:
        """Advance stepper and derivatives; see `Stepper.advance`."""
        stepper = self.stepper
        state, modes = stepper.state.copy(), stepper.modes
        begin, start = stepper.clock, stepper.base + stepper.clock
        event = stepper.advance(until)
        if not self._valid:
            return event
        if event is not None and event[1] in (HOLD, RELEASE):
            self._valid = False
            return event
        end = begin + (stepper.base + stepper.clock - start)
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
            self._valid = False
            return
        arrival, sensitivity = self._row[:n], self._row[n:].reshape(n, n + 1)
        rates = compiled.rates(key)
        moved = self._states
        if forced:
            moved = moved - np.outer(rates.one(state, begin, numbers), self._clock)
        change = sensitivity[:, :n] @ moved  # derivatives of the arrival at a fixed clock
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


SAMPLES, BLOCKS = 1200, 20
PATIENCE, FORGET = 8, 50  # longest wait for equal modes, in samples; first samples that are left out
EARLY, CLEAR = (
    4,
    8.0,
)  # after 1/EARLY of the samples an exponent above CLEAR standard errors is accepted


def growth(stepper: Stepper, samples: int = SAMPLES) -> tuple[float, float]:
    """Return the Lyapunov exponent per forcing period (of a self-excited machine: per event), and its standard error.

    After Benettin, Galgani, Giorgilli and Strelcyn (Meccanica 15 (1980) 9): the mean logarithm of the growth of the distance between two
    neighbours; the scatter of twenty blocks gives the error. While the neighbours are in different modes (one of them has passed an event
    that the other has not yet reached) no sample is taken.

    Parameters
    ----------
    stepper : Stepper
        At a state of the motion; it is advanced.
    samples : int
        Number of samples.
    """
    other = Stepper(stepper.machine, stepper.params)
    generator = np.random.default_rng(1)
    _displace(stepper, other, generator.standard_normal(len(stepper.state)))
    start = _distance(stepper, other)[1]
    logs: list[float] = []
    waited, tries = 1, 0
    while len(logs) < samples and tries < 4 * samples:
        tries += 1
        if len(logs) == samples // EARLY and tries > FORGET:
            exponent, error = mean_of_blocks(np.array(logs), BLOCKS)
            if exponent > CLEAR * error:  # certainly chaotic
                return exponent, error
        same_modes = _advance_both(stepper, other)
        separation, size = _distance(stepper, other)
        if not same_modes and waited < PATIENCE and size < SIMULATING.far:
            waited += 1
            continue
        if same_modes and start > 0.0 and size > 0.0:
            if tries > FORGET:
                logs.append(math.log(size / start) / waited)
        else:
            separation = generator.standard_normal(len(stepper.state))
        _displace(stepper, other, separation)
        start = _distance(stepper, other)[1]
        waited = 1
    if len(logs) < BLOCKS:
        return math.nan, math.nan
    return mean_of_blocks(np.array(logs), BLOCKS)


def _displace(stepper: Stepper, other: Stepper, direction: np.ndarray) -> None:
    scale = SIMULATING.nudge * (1.0 + float(np.abs(stepper.state).max()))
    state = stepper.state + scale * direction / max(float(np.abs(direction).max()), SMALLEST)
    other.start(state, stepper.clock, stepper.modes)
    other.base = stepper.base


def _distance(stepper: Stepper, other: Stepper) -> tuple[np.ndarray, float]:
    separation = other.state - stepper.state
    return separation, float(np.abs(separation).max())


def _advance_both(stepper: Stepper, other: Stepper) -> bool:
    """Move both on by a forcing period (or an event); return whether they are in the same modes then."""
    if not stepper.machine.forced:
        event, image = (
            stepper.advance(stepper.base + SIMULATING.wait),
            other.advance(other.base + SIMULATING.wait),
        )
        return event == image and stepper.modes == other.modes
    until = stepper.base + stepper.clock + TWO_PI
    for each in (stepper, other):
        while each.advance(until) is not None:
            pass
    return stepper.modes == other.modes
