"""Transients: free decay, a shock, a recorded motion of the base; what the absorber takes, and the bare oscillator beside it.

The free decay is simulated event by event (`orbits.simulation`). A recorded motion is given as the base's acceleration at instants and runs
linearly between them; relative to the base the machine then is

    x1'' + eps lambda x1' + x1 = -e'' - eps mu g S,    x2'' = -e'' + mu g S,    w = x1 - x2,

with constant S between events, so that the oscillator's motion is a decaying oscillation about a straight line and the absorber's a cubic:
exact from instant to instant, events bracketed in steps of a hundredth of the natural period and found to roundoff.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numba import njit

from orbits.machines.base import ParameterError
from orbits.simulation.driver import simulate

NINE_TENTHS = 0.9
LONGEST = 4000.0  # forcing periods of a free decay


@dataclass(frozen=True, eq=False)
class Decay:
    """A free decay; energies in units of the machine's own, times in 1/omega_0.

    Attributes
    ----------
    times, energy : float array
        Energy of oscillator and absorber together.
    bare : float array
        Of the oscillator without absorber, at the same times.
    impacts, friction, damping : float
        Dissipated until the end.
    pumping_time, bare_time : float
        When nine tenths of the energy are gone, with the absorber and without; nan where the run ends first.
    """

    times: np.ndarray
    energy: np.ndarray
    bare: np.ndarray
    impacts: float
    friction: float
    damping: float
    pumping_time: float
    bare_time: float

    @property
    def absorber_share(self) -> float:
        """Share of what is dissipated that impacts and friction take."""
        lost = self.impacts + self.friction + self.damping
        return (self.impacts + self.friction) / lost if lost > 0.0 else math.nan


def free_decay(model: Any, params: np.ndarray, displacement: float, lost: float = NINE_TENTHS) -> Decay:
    """The decay of the machine after the oscillator is let go, the absorber at rest in the middle of the cavity.

    Parameters
    ----------
    model : Model
        A machine with an oscillator.
    params : float array (P,)
    displacement : float
        Of oscillator and absorber, in half-widths.
    lost : float
        The share of the energy whose loss is the pumping time.

    Raises
    ------
    ParameterError
        If the machine has no oscillator, or nothing moves.
    """
    numbers = dict(zip(model.parameter_names, (float(x) for x in params)))
    if "damping" not in numbers:
        raise ParameterError(f"the machine {model.name!r} has no oscillator whose motion could decay")
    if not (math.isfinite(displacement) and displacement != 0.0):
        raise ParameterError(f"displacement = {displacement!r}: give a number other than 0")
    numbers |= {"forcing": 0.0, "frequency": 1.0}
    eps, damping = numbers["mass_ratio"], numbers["damping"]
    state: Any = {"q1": displacement, "q2": displacement}
    first = 0.5 * displacement**2  # of the spring; the energies below are in the same unit
    times, energy, parts = [0.0], [1.0], np.zeros(3)
    while energy[-1] > 1.0 - lost and len(times) <= LONGEST:
        run = simulate(model, state, periods=1.0, events=None, **numbers)
        balance = run.balance()
        taken = np.array([balance.impacts, balance.friction, balance.damping])
        parts += taken
        times.append(times[-1] + 2.0 * math.pi)
        energy.append(_energy(run.end, eps) / first)
        state = run.end
        if abs(taken.sum()) < 1e-9 * first:
            break
    t, e = np.array(times), np.array(energy)
    rate = 0.5 * eps * damping
    fast = math.sqrt(max(1.0 - rate * rate, 0.0))
    decay = np.exp(-rate * t)
    q = decay * (np.cos(fast * t) + rate / fast * np.sin(fast * t))
    speed = -decay * np.sin(fast * t) / fast
    gone = -math.log(1.0 - lost) / (2.0 * rate) if rate > 0.0 else math.nan
    impacts, friction, damper = (float(x) for x in parts)
    when = _when(t, e, 1.0 - lost)
    return Decay(t, e, q * q + speed * speed, impacts, friction, damper, when, gone)


def _energy(state: np.ndarray, eps: float) -> float:
    """Energy of oscillator and absorber, (q1'^2 + q1^2 + eps q2'^2)/2, of a state."""
    from orbits.machines.stepping import RATE, V_RATE, V, W

    w, w_rate, v, v_rate = (float(state[i]) for i in (W, RATE, V, V_RATE))
    q1 = (v + eps * w) / (1.0 + eps)
    q1_rate, q2_rate = (v_rate + eps * w_rate) / (1.0 + eps), (v_rate - w_rate) / (1.0 + eps)
    return 0.5 * (q1 * q1 + q1_rate * q1_rate + eps * q2_rate * q2_rate)


def _when(times: np.ndarray, energy: np.ndarray, level: float) -> float:
    """When the energy first falls to `level`, between two samples geometrically."""
    below = np.flatnonzero(energy <= level)
    if not below.size:
        return math.nan
    i = int(below[0])
    if i == 0:
        return float(times[0])
    share = math.log(energy[i - 1] / level) / math.log(energy[i - 1] / max(energy[i], 1e-300))
    return float(times[i - 1] + share * (times[i] - times[i - 1]))


@dataclass(frozen=True, eq=False)
class Response:
    """The answer to a recorded motion of the base, in the machine's own units.

    Attributes
    ----------
    times : float array (n,)
    oscillator, relative, bare : float array (n,)
        Displacement x1 of the oscillator from the base, w = x1 - x2, and x1 of the oscillator without absorber.
    impacts, friction, damping : float
        Dissipated, in the unit of x1'^2.
    impact_times : float array
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
        """The same without absorber."""
        return float(np.abs(self.bare).max())

    @property
    def absorber_share(self) -> float:
        """Share of what is dissipated that impacts and friction take."""
        lost = self.impacts + self.friction + self.damping
        return (self.impacts + self.friction) / lost if lost > 0.0 else math.nan


def recorded(
    model: Any, params: np.ndarray, times: np.ndarray, acceleration: np.ndarray, tail: float = 0.0
) -> Response:
    """The answer of the machine, from rest, to a recorded acceleration of its base.

    Parameters
    ----------
    model : Model
        A machine with an oscillator.
    params : float array (P,)
    times : float array (n,)
        Ascending, in 1/omega_0.
    acceleration : float array (n,)
        Of the base, in half-widths times omega_0^2; linear between the instants.
    tail : float
        How long the motion is followed after the last instant, the base unaccelerated.

    Raises
    ------
    ParameterError
        If the machine has no oscillator, or the record cannot be.
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
    numbers = dict(zip(model.parameter_names, (float(x) for x in params)))
    if "damping" not in numbers:
        raise ParameterError(f"the machine {model.name!r} has no oscillator")
    if tail > 0.0:
        times = np.append(times, [times[-1] + 1e-9, times[-1] + tail])
        acceleration = np.append(acceleration, [0.0, 0.0])
    eps, r = numbers["mass_ratio"], numbers["restitution"]
    steps = np.maximum(np.ceil(np.diff(times) / (0.02 * math.pi)), 1).astype(np.int64)
    out = np.zeros((int(steps.sum()) + 1, 4))
    hits, lost = np.zeros(100_000), np.zeros(3)
    rate, pull = eps * numbers["damping"], numbers["friction"] * numbers["gravity"]
    count = _march(times, acceleration, steps, rate, eps, pull, r, out, hits, lost)
    impacts, friction, damper = (float(x) for x in lost)
    return Response(
        out[:, 0], out[:, 1], out[:, 2], out[:, 3], impacts, friction, damper, hits[:count].copy()
    )


@njit(cache=True, error_model="numpy")
def _drift(x, v, mass, rate, force, slope, t):
    """Displacement and speed after t of mass x'' + rate x' + x = force + slope t."""
    alpha = 0.5 * rate / mass
    beta = math.sqrt(1.0 / mass - alpha * alpha)
    offset = force - rate * slope
    z, zr = x - offset, v - slope
    decay, c, s = math.exp(-alpha * t), math.cos(beta * t), math.sin(beta * t) / beta
    y = decay * (z * c + (zr + alpha * z) * s)
    yr = decay * (zr * c - (alpha * zr + z / mass) * s)
    return y + offset + slope * t, yr + slope


@njit(cache=True, error_model="numpy")
def _at(state, mode, rate, eps, pull, a0, a1, t):
    """(x1, v1, x2, v2) after t in a mode: -1, +1 slide, 0 stick; the base's acceleration is a0 + a1 t."""
    x1, v1, x2, v2 = state
    if mode == 0:
        y, yr = _drift(x1, v1, 1.0 + eps, rate, -(1.0 + eps) * a0, -(1.0 + eps) * a1, t)
        return y, yr, x2 + y - x1, yr
    y, yr = _drift(x1, v1, 1.0, rate, -a0 - eps * pull * mode, -a1, t)
    push = pull * mode - a0
    return y, yr, x2 + (v2 + (0.5 * push - a1 * t / 6.0) * t) * t, v2 + (push - 0.5 * a1 * t) * t


@njit(cache=True, error_model="numpy")
def _watch(state, mode, rate, eps, pull, a0, a1, t, what):
    """What vanishes at an event: 0, 1 the walls, 2 the relative speed, 3, 4 the reserve of friction while stuck."""
    x1, v1, x2, v2 = _at(state, mode, rate, eps, pull, a0, a1, t)
    if what == 0:
        return 1.0 - (x1 - x2)
    if what == 1:
        return 1.0 + (x1 - x2)
    if what == 2:
        return mode * (v1 - v2)
    need = -(rate * v1 + x1) / (1.0 + eps)  # relative to inertia: x2'' + e'' while stuck
    return pull - need if what == 3 else pull + need


@njit(cache=True, error_model="numpy")
def _march(times, acceleration, steps, rate, eps, pull, r, out, hits, lost):
    """Through the record; fills rows (time, x1, w, bare x1), times of impacts and (impacts, friction, damping)."""
    state = (0.0, 0.0, 0.0, 0.0)
    bare, bare_rate = 0.0, 0.0
    mode = 0 if pull > 0.0 else 1
    row, count = 1, 0
    out[0, 0] = times[0]
    for k in range(steps.size):
        span = times[k + 1] - times[k]
        a1 = (acceleration[k + 1] - acceleration[k]) / span
        for j in range(steps[k]):
            h = span / steps[k]
            a0 = acceleration[k] + a1 * h * j
            now = times[k] + h * j
            bare, bare_rate = _drift(bare, bare_rate, 1.0, rate, -a0, -a1, h)
            left, tries = h, 0
            while left > 0.0 and tries < 200:
                tries += 1
                first, which = left, -1
                lowest = 3 if mode == 0 else 0
                for what in range(lowest, 5 if mode == 0 else (3 if pull > 0.0 else 2)):
                    if _watch(state, mode, rate, eps, pull, a0, a1, first, what) >= 0.0:
                        continue
                    low, high = 0.0, first
                    while high - low > 1e-15 * (1.0 + first):
                        middle = 0.5 * (low + high)
                        if middle <= low or middle >= high:
                            break
                        if _watch(state, mode, rate, eps, pull, a0, a1, middle, what) >= 0.0:
                            low = middle
                        else:
                            high = middle
                    first, which = high, what
                x1, v1, x2, v2 = _at(state, mode, rate, eps, pull, a0, a1, first)
                lost[2] += rate * 0.5 * (state[1] * state[1] + v1 * v1) * first
                if mode != 0:
                    lost[1] += eps * pull * abs((x1 - x2) - (state[0] - state[2]))
                a0 += a1 * first
                left -= first
                now += first
                if which == 0 or which == 1:
                    w_rate, v_rate = v1 - v2, v1 + eps * v2
                    lost[0] += 0.5 * eps / (1.0 + eps) * (1.0 - r * r) * w_rate * w_rate
                    if count < hits.size:
                        hits[count] = now
                        count += 1
                    after = -r * w_rate
                    v2 = (v_rate - after) / (1.0 + eps)
                    v1 = v2 + after
                    x2 = x1 - (1.0 if which == 0 else -1.0)
                    mode = 1 if after > 0.0 else -1
                    if abs(after) < 1e-9 and pull > 0.0:
                        v2 = v1
                        mode = 0
                elif which == 2:
                    need = -(rate * v1 + x1) / (1.0 + eps)
                    v2 = v1
                    mode = 0 if abs(need) <= pull else (1 if need > 0.0 else -1)
                elif which >= 3:
                    mode = 1 if which == 3 else -1
                state = (x1, v1, x2, v2)
            out[row, 0] = times[k] + h * (j + 1)
            out[row, 1] = state[0]
            out[row, 2] = state[0] - state[2]
            out[row, 3] = bare
            row += 1
    return count
