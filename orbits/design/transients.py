"""Transients: the free decay, and the bare oscillator beside it; a recorded motion of the base is in `orbits.design.record`.

The free decay is simulated event by event (`orbits.simulation`).
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from orbits.design.record import Dissipation, oscillator_numbers
from orbits.machines.base import ParameterError
from orbits.numbers import SMALLEST
from orbits.settings import DESIGNING
from orbits.simulation.runs import simulate

if TYPE_CHECKING:
    from orbits.machines.base import Model

NINE_TENTHS = 0.9
LONGEST = 4000.0  # forcing periods of a free decay


@dataclass(frozen=True, eq=False)
class Decay(Dissipation):
    """A free decay; energies are those of vibration (kinetic, and of the spring) over the first one, times in 1/omega_0.

    Attributes
    ----------
    times, energy : float array
        Of oscillator and absorber together. On a slope it ends at zero, too: displacements count from where both rest. What gravity has
        done on the way down is in `impacts` and `friction`.
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


def free_decay(model: Model, params: np.ndarray, displacement: float) -> Decay:
    """The decay of the machine after the oscillator is let go, the absorber at rest in the middle of the cavity.

    Parameters
    ----------
    model : Model
        A machine with an oscillator.
    params : float array (P,)
    displacement : float
        Of oscillator and absorber, in half-widths.

    Raises
    ------
    ParameterError
        If the machine has no oscillator, or nothing moves.
    """
    numbers = oscillator_numbers(model, params)
    if not (math.isfinite(displacement) and displacement != 0.0):
        raise ParameterError(f"displacement = {displacement!r}: give a number other than 0")
    numbers |= {"forcing": 0.0, "frequency": 1.0}
    eps, damping = numbers["mass_ratio"], numbers["damping"]
    state = {"q1": displacement, "q2": displacement}
    first = 0.5 * displacement**2  # of the spring; the energies below are in the same unit
    times, energy, parts = [0.0], [1.0], np.zeros(3)
    while energy[-1] > 1.0 - NINE_TENTHS and len(times) <= LONGEST:
        run = simulate(model, state, periods=1.0, events=None, **numbers)
        balance = run.balance()
        taken = np.array([balance.impacts, balance.friction, balance.damping])
        parts += taken
        times.append(times[-1] + 2.0 * math.pi)
        energy.append(_energy(run.end, eps) / first)
        state = run.end
        if abs(taken.sum()) < DESIGNING.exhausted * first:
            break
    t, e = np.array(times), np.array(energy)
    rate = 0.5 * eps * damping
    fast = math.sqrt(max(1.0 - rate * rate, 0.0))
    decay = np.exp(-rate * t)
    q = decay * (np.cos(fast * t) + rate / fast * np.sin(fast * t))
    speed = -decay * np.sin(fast * t) / fast
    gone = -math.log(1.0 - NINE_TENTHS) / (2.0 * rate) if rate > 0.0 else math.nan
    impacts, friction, damper = (float(x) for x in parts)
    when = _when(t, e, 1.0 - NINE_TENTHS)
    return Decay(t, e, q * q + speed * speed, impacts, friction, damper, when, gone)


def taken_share(model: Model, params: np.ndarray, displacement: float, time: float) -> float:
    """Share of the initial energy that impacts and friction have taken in so much time [1/omega_0] of the free decay, beside what gravity gave.

    Raises
    ------
    ParameterError
        As `free_decay` does, and for a time that is not above 0.
    """
    if not (0.0 < time <= 2.0 * math.pi * LONGEST):
        raise ParameterError(
            f"time = {time:g} is out of range; give a time above 0, of at most {LONGEST:g} periods"
        )
    numbers: dict[str, Any] = model.named(params) | {
        "forcing": 0.0,
        "frequency": 1.0,
    }
    run = simulate(model, {"q1": displacement, "q2": displacement}, periods=time / (2.0 * math.pi), **numbers)
    left = _energy(run.end, numbers["mass_ratio"]) + run.balance().damping
    return 1.0 - float(left) / (0.5 * displacement**2)


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
    share = math.log(energy[i - 1] / level) / math.log(energy[i - 1] / max(energy[i], SMALLEST))
    return float(times[i - 1] + share * (times[i] - times[i - 1]))
