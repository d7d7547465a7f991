"""Response of a machine to a recorded motion of its base, for example a shock.

The record holds the base's acceleration at given instants; it is linear between them. Relative to the base the equations of motion are

    x1'' + eps lambda x1' + x1 = -e'' - eps mu g S,    x2'' = -e'' + mu g S,    w = x1 - x2,

with S constant between events. So the oscillator's motion is a decaying oscillation about a straight line and the absorber's motion is a cubic,
both exact between instants. Events are bracketed in steps of a hundredth of the natural period and located to roundoff. Impacts that accumulate at a
wall end in lasting contact: oscillator and absorber then move as one until the force that holds the absorber, which the wall cannot pull,
exceeds the friction.
"""

from __future__ import annotations

import ctypes
import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar

import numpy as np

from contvines.core.library import NUMBER, POINTER, WHOLE, address, function, native
from orbits.machines.base import ParameterError
from orbits.settings import EVENTS, REPLAYING, SIMULATING

if TYPE_CHECKING:
    from orbits.machines.base import Model
    from orbits.machines.varying import Varying


MOST_EVENTS = 20_000  # most events in one step of a hundredth of the natural period
SLICE = 20_000  # rows computed by one call of the native core; interrupts are handled between calls
BAND = 0.05  # largest deviation of a settled response's size, relative to its final size


class Dissipation:
    """Energy that impacts, friction and the oscillator's own damping have dissipated until the end of a motion."""

    impacts: float
    friction: float
    damping: float

    @property
    def absorber_share(self) -> float:
        """Energy dissipated by impacts and friction, relative to all dissipated energy; nan if none is dissipated."""
        lost = self.impacts + self.friction + self.damping
        return (self.impacts + self.friction) / lost if lost > 0.0 else math.nan


@dataclass(frozen=True, eq=False)
class Response(Dissipation):
    """Response to a recorded motion of the base, in the machine's own units.

    Attributes
    ----------
    times : float array (n,)
    oscillator, relative, bare : float array (n,)
        Displacement x1 of the oscillator from the base, w = x1 - x2, and x1 of an oscillator without absorber.
    impacts, friction, damping : float
        Dissipated energies, in the unit of x1'^2.
    impact_times : float array (k,)
    """

    times: np.ndarray
    oscillator: np.ndarray
    relative: np.ndarray
    bare: np.ndarray
    impacts: float
    friction: float
    damping: float
    impact_times: np.ndarray

    @property
    def peak(self) -> float:
        """Largest displacement of the oscillator."""
        return float(np.abs(self.oscillator).max())

    @property
    def bare_peak(self) -> float:
        """Largest displacement of an oscillator without absorber."""
        return float(np.abs(self.bare).max())


def oscillator_numbers(model: Varying, params: np.ndarray) -> dict[str, float]:
    """Return the parameters of a machine with an oscillator by name; raise a `ParameterError` for any other machine."""
    numbers = model.named(params)
    if "damping" not in numbers:
        raise ParameterError(f"the machine {model.name!r} has no oscillator on a base")
    return numbers


def recorded(
    model: Model, params: np.ndarray, times: np.ndarray, acceleration: np.ndarray, tail: float = 0.0
) -> Response:
    """Simulate the machine, from rest, under a recorded acceleration of its base.

    Parameters
    ----------
    model : Model
        A machine with an oscillator.
    params : float array (P,)
    times : float array (n,)
        Ascending, in 1/omega_0.
    acceleration : float array (n,)
        Acceleration of the base, in half-widths times omega_0^2; linear between the instants.
    tail : float
        Time that is simulated after the last instant, without acceleration of the base.

    Returns
    -------
    Response

    Raises
    ------
    ParameterError
        If the machine has no oscillator or an inclined cavity, if the record is not valid, or if there are too many events.
    """
    times, acceleration = np.asarray(times, dtype=float), np.asarray(acceleration, dtype=float)
    if times.ndim != 1 or times.shape != acceleration.shape or times.size < 2:
        raise ParameterError(
            "the record needs two columns of equal length, time and acceleration, with two rows or more"
        )
    if not (np.all(np.isfinite(times)) and np.all(np.isfinite(acceleration))):
        raise ParameterError("the record has numbers that are not finite: leave those rows out")
    if np.any(np.diff(times) <= 0.0):
        at = int(np.flatnonzero(np.diff(times) <= 0.0)[0]) + 1
        raise ParameterError(f"the record's times do not grow at row {at}: sort them, one row per instant")
    numbers = oscillator_numbers(model, params)
    if numbers.get("slope", 0.0) != 0.0:
        raise ParameterError(
            "a recorded motion of the base is followed for level cavities only: use slope = 0"
        )
    if tail > 0.0:
        times = np.append(times, [times[-1] + SIMULATING.whole_period, times[-1] + tail])
        acceleration = np.append(acceleration, [0.0, 0.0])
    eps, r = numbers["mass_ratio"], numbers["restitution"]
    steps = np.maximum(np.ceil(np.diff(times) / (0.02 * math.pi)), 1).astype(np.int64)
    rows = np.zeros((int(steps.sum()) + 1, 4))
    hits, lost = np.zeros(100_000), np.zeros(3)
    rate, pull = eps * numbers["damping"], numbers["friction"] * numbers["gravity"]
    count = _march(times, acceleration, steps, (rate, eps, pull, r), rows, hits, lost)
    if count < 0:
        raise ParameterError(
            f"the machine has more than {MOST_EVENTS} events in a hundredth of its natural period: the record's acceleration "
            "is too large for it; check its unit"
        )
    impacts, friction, damper = (float(x) for x in lost)
    return Response(
        rows[:, 0], rows[:, 1], rows[:, 2], rows[:, 3], impacts, friction, damper, hits[:count].copy()
    )


def _drift(x, v, mass, rate, force, slope, t):
    """Return displacement and speed after time t of mass x'' + rate x' + x = force + slope t."""
    alpha = 0.5 * rate / mass
    beta = math.sqrt(1.0 / mass - alpha * alpha)
    offset = force - rate * slope
    z, zr = x - offset, v - slope
    decay, c, s = math.exp(-alpha * t), math.cos(beta * t), math.sin(beta * t) / beta
    y = decay * (z * c + (zr + alpha * z) * s)
    yr = decay * (zr * c - (alpha * zr + z / mass) * s)
    return y + offset + slope * t, yr + slope


def _state_after(state, mode, rate, eps, pull, a0, a1, t):
    """Return (x1, v1, x2, v2) after time t in a mode (-1, +1: sliding; 0: sticking), with the base's acceleration a0 + a1 t."""
    x1, v1, x2, v2 = state
    if mode == 0:
        y, yr = _drift(x1, v1, 1.0 + eps, rate, -(1.0 + eps) * a0, -(1.0 + eps) * a1, t)
        return y, yr, x2 + y - x1, yr
    y, yr = _drift(x1, v1, 1.0, rate, -a0 - eps * pull * mode, -a1, t)
    push = pull * mode - a0
    return y, yr, x2 + (v2 + (0.5 * push - a1 * t / 6.0) * t) * t, v2 + (push - 0.5 * a1 * t) * t


def _watch(state, mode, rate, eps, pull, a0, a1, t, event):
    """Return the function that vanishes at event `event` after time t: 0, 1 distances to the walls; 2 relative speed; 3, 4 margins of friction while sticking."""
    x1, v1, x2, v2 = _state_after(state, mode, rate, eps, pull, a0, a1, t)
    if event == 0:
        return 1.0 - (x1 - x2)
    if event == 1:
        return 1.0 + (x1 - x2)
    if event == 2:
        return mode * (v1 - v2)
    need = -(rate * v1 + x1) / (1.0 + eps)  # x2'' + e'' while stuck: friction force per absorber mass
    return pull - need if event == 3 else pull + need


class _State(ctypes.Structure):
    """State of the integration between two calls of the native core; `RecordState` of `native/record.hpp`."""

    _fields_: ClassVar = [
        *((name, NUMBER) for name in ("x1", "v1", "x2", "v2", "bare", "bare_rate")),
        *((name, WHOLE) for name in ("mode", "wall", "row", "hits", "place", "step")),
        ("lost", NUMBER * 3),
    ]


def _march(
    times: np.ndarray,
    acceleration: np.ndarray,
    steps: np.ndarray,
    machine: tuple[float, float, float, float],
    rows: np.ndarray,
    hits: np.ndarray,
    lost: np.ndarray,
) -> int:
    """Do `_march_plainly` with the native core if there is one, in slices, so that an interrupt is handled between calls."""
    if not native():
        return _march_plainly(times, acceleration, steps, machine, rows, hits, lost)
    arrays = [np.ascontiguousarray(x, dtype=float) for x in (times, acceleration)]
    work = function(
        "record_march", WHOLE, POINTER, WHOLE, *[POINTER] * 3, *[NUMBER] * 4, POINTER, POINTER, WHOLE, WHOLE
    )
    state = _State(mode=0 if machine[2] > 0.0 else 1, row=1)
    rows[0, 0] = times[0]
    more = 1
    while more == 1:
        more = work(
            ctypes.addressof(state),
            len(steps),
            *map(address, (*arrays, steps)),
            *machine,
            address(rows),
            address(hits),
            len(hits),
            SLICE,
        )
    lost[:] = state.lost
    return int(state.hits) if more == 0 else -1


def _march_plainly(
    times: np.ndarray,
    acceleration: np.ndarray,
    steps: np.ndarray,
    machine: tuple[float, float, float, float],
    rows: np.ndarray,
    hits: np.ndarray,
    lost: np.ndarray,
) -> int:
    """Integrate the whole record; fill `rows` with rows (time, x1, w, bare x1), `hits` with times of impacts, `lost` with dissipated energies (impacts, friction, damping).

    While the mode is 0 (both masses move as one), `wall` is +1 or -1 if the absorber lies against the left or right wall, which only pushes, else 0.
    Return the number of impacts, or -1 if one step has more than `MOST_EVENTS` events.
    """
    rate, eps, pull, r = machine
    state = (0.0, 0.0, 0.0, 0.0)
    bare, bare_rate = 0.0, 0.0
    mode = 0 if pull > 0.0 else 1
    wall = 0
    row, count = 1, 0
    rows[0, 0] = times[0]
    for k in range(steps.size):
        span = times[k + 1] - times[k]
        a1 = (acceleration[k + 1] - acceleration[k]) / span
        for j in range(steps[k]):
            h = span / steps[k]
            a0 = acceleration[k] + a1 * h * j
            time = times[k] + h * j
            bare, bare_rate = _drift(bare, bare_rate, 1.0, rate, -a0, -a1, h)
            left, tries = h, 0
            while left > 0.0:
                tries += 1
                if tries > MOST_EVENTS:
                    return -1
                first, met = left, -1
                lowest = 3 if mode == 0 else 0
                for event in range(lowest, 5 if mode == 0 else (3 if pull > 0.0 else 2)):
                    if mode == 0 and ((event == 3 and wall == 1) or (event == 4 and wall == -1)):
                        continue  # the wall supports the absorber on this side
                    if _watch(state, mode, rate, eps, pull, a0, a1, first, event) >= 0.0:
                        continue
                    low, high = 0.0, first
                    while high - low > REPLAYING.rounding * (1.0 + first):
                        middle = 0.5 * (low + high)
                        if middle <= low or middle >= high:
                            break
                        if _watch(state, mode, rate, eps, pull, a0, a1, middle, event) >= 0.0:
                            low = middle
                        else:
                            high = middle
                    first, met = high, event
                x1, v1, x2, v2 = _state_after(state, mode, rate, eps, pull, a0, a1, first)
                lost[2] += rate * 0.5 * (state[1] * state[1] + v1 * v1) * first
                if mode != 0:
                    lost[1] += eps * pull * abs((x1 - x2) - (state[0] - state[2]))
                a0 += a1 * first
                left -= first
                time += first
                if met == 0 or met == 1:
                    w_rate, v_rate = v1 - v2, v1 + eps * v2
                    lost[0] += 0.5 * eps / (1.0 + eps) * (1.0 - r * r) * w_rate * w_rate
                    if count < hits.size:
                        hits[count] = time
                        count += 1
                    after = -r * w_rate
                    v2 = (v_rate - after) / (1.0 + eps)
                    v1 = v2 + after
                    x2 = x1 - (1.0 if met == 0 else -1.0)
                    mode = 1 if after > 0.0 else -1
                    side = 1 if met == 0 else -1
                    need = -(rate * v1 + x1) / (1.0 + eps)
                    if abs(after) < EVENTS.touch and side * need > -pull:
                        v2 = v_rate / (1.0 + eps)
                        v1 = v2
                        mode, wall = 0, side
                elif met == 2:
                    need = -(rate * v1 + x1) / (1.0 + eps)
                    v2 = v1
                    mode, wall = (0 if abs(need) <= pull else (1 if need > 0.0 else -1)), 0
                elif met >= 3:
                    mode, wall = (1 if met == 3 else -1), 0
                state = (x1, v1, x2, v2)
            rows[row, 0] = times[k] + h * (j + 1)
            rows[row, 1] = state[0]
            rows[row, 2] = state[0] - state[2]
            rows[row, 3] = bare
            row += 1
    return count


def settled(times: np.ndarray, motion: np.ndarray, periods: int) -> float:
    """Return the time from which on the largest displacement of every period stays within `BAND` of the final one; nan if it does not settle.

    The final value is the mean over the last quarter of the periods, which itself must be steady.

    Parameters
    ----------
    times, motion : float array (n,)
        Evenly spaced, from time 0.
    periods : int
        Number of periods that they cover.
    """
    sizes = np.array([np.abs(part).max() for part in np.array_split(motion, periods)])
    last = sizes[-max(1, periods // 4) :]
    outside = np.abs(sizes - last.mean()) > BAND * last.mean()
    if outside[-len(last) :].any():
        return math.nan
    first = int(np.flatnonzero(outside)[-1]) + 1 if outside.any() else 0
    return float(times[-1] * first / periods)
