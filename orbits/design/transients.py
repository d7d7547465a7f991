"""Transients of built-in machines: free decay and start from rest, each compared with the bare oscillator.

They are simulated event by event (`orbits.simulation`). For a recorded motion of the base see `orbits.design.record`.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from orbits.arguments import SMALLEST
from orbits.design.record import Dissipation, oscillator_numbers, settled
from orbits.machines.base import ParameterError
from orbits.machines.physical.machine import Physical
from orbits.settings import DESIGNING
from orbits.simulation.runs import simulate

if TYPE_CHECKING:
    from orbits.machines.base import Model
    from orbits.machines.varying import Varying


NINE_TENTHS = 0.9  # share of the initial energy whose loss defines the pumping time
LONGEST = 4000.0  # longest free decay, in natural periods
FEWEST, MOST = 60, 2000  # shortest and longest start from rest, in forcing periods
CONSTANTS = 6.0  # default duration of a start from rest, in time constants of the bare oscillator
PER_PERIOD = 80  # samples per forcing period


@dataclass(frozen=True, eq=False)
class Decay(Dissipation):
    """A free decay; energies of vibration (kinetic energy and that of the spring) are relative to the initial one, times are in 1/omega_0.

    Attributes
    ----------
    times, energy : float array
        Energy of oscillator and absorber together. With an inclined cavity it ends at zero, too, because displacements are measured from
        the position of rest; the work of gravity is contained in `impacts` and `friction`.
    bare : float array
        Energy of the oscillator without absorber, at the same times.
    impacts, friction, damping : float
        Energies dissipated until the end.
    pumping_time, bare_time : float
        Times at which nine tenths of the energy are lost, with and without the absorber; nan if the simulation ends before.
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
    """Simulate the decay after the oscillator is released from a displacement, with the absorber at rest in the middle of the cavity.

    Parameters
    ----------
    model : Model
        A machine with an oscillator.
    params : float array (P,)
    displacement : float
        Initial displacement of oscillator and absorber, in half-widths; not 0.

    Returns
    -------
    Decay

    Raises
    ------
    ParameterError
        If the machine has no oscillator, or the displacement is 0 or not finite.
    """
    numbers = oscillator_numbers(model, params)
    if not (math.isfinite(displacement) and displacement != 0.0):
        raise ParameterError(f"displacement = {displacement!r}: give a number other than 0")
    numbers |= {"forcing": 0.0, "frequency": 1.0}
    eps, damping = numbers["mass_ratio"], numbers["damping"]
    state = {"q1": displacement, "q2": displacement}
    first = 0.5 * displacement**2  # initial energy of the spring; the energies below are in the same unit
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
    bare_time = -math.log(1.0 - NINE_TENTHS) / (2.0 * rate) if rate > 0.0 else math.nan
    impacts, friction, damper = (float(x) for x in parts)
    decay_time = _time_at_level(t, e, 1.0 - NINE_TENTHS)
    return Decay(t, e, q * q + speed * speed, impacts, friction, damper, decay_time, bare_time)


def taken_share(model: Model, params: np.ndarray, displacement: float, time: float) -> float:
    """Share of the initial energy that impacts and friction have dissipated after a time of the free decay; the work of gravity is not counted.

    Parameters
    ----------
    model, params, displacement
        As for `free_decay`.
    time : float
        In 1/omega_0.

    Raises
    ------
    ParameterError
        If the time is not above 0, or too long.
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


def _time_at_level(times: np.ndarray, energy: np.ndarray, level: float) -> float:
    """Return the time at which the energy first falls to `level`, with geometric interpolation between samples; nan if it does not."""
    below = np.flatnonzero(energy <= level)
    if not below.size:
        return math.nan
    i = int(below[0])
    if i == 0:
        return float(times[0])
    share = math.log(energy[i - 1] / level) / math.log(energy[i - 1] / max(energy[i], SMALLEST))
    return float(times[i - 1] + share * (times[i] - times[i - 1]))


@dataclass(frozen=True, eq=False)
class StartUp(Dissipation):
    """Start of a machine from rest; lengths in half-widths, times in 1/omega_0, energies in the machine's own unit.

    Attributes
    ----------
    times, oscillator, relative, bare : float array
        Times, and displacements of the oscillator, of the oscillator relative to the absorber, and of the bare oscillator.
    impact_times, impact_speeds : float array
    impacts, friction, damping : float
        Energies dissipated until the end.
    settled, bare_settled : float
        Time from which on the largest displacement of every forcing period stays within 5 % of that of the last periods, with and without the absorber; nan if it does not settle.
    """

    times: np.ndarray
    oscillator: np.ndarray
    relative: np.ndarray
    bare: np.ndarray
    impact_times: np.ndarray
    impact_speeds: np.ndarray
    impacts: float
    friction: float
    damping: float
    settled: float
    bare_settled: float


def start_up(
    model: Varying, params: np.ndarray, periods: int | None = None, run_up: tuple[float, float] | None = None
) -> StartUp:
    """Simulate the machine from rest, with the absorber in the middle; the excitation begins at time 0 with phase 0.

    Parameters
    ----------
    model : Model
        A machine with an oscillator.
    params : float array (P,)
    periods : int, optional
        Forcing periods (after the run-up, if there is one); default: six time constants of the bare oscillator, 60 to 2000 periods.
    run_up : (float, float), optional
        Initial frequency (in omega_0) and duration (in 1/omega_0) of a run-up, in which the frequency rises linearly to that of the machine.

    Returns
    -------
    StartUp

    Raises
    ------
    ParameterError
        If the machine has no oscillator, or the number of periods is out of range.
    """
    numbers = oscillator_numbers(model, params)
    omega = float(model.phase_speed(params))
    rate = 0.5 * numbers["mass_ratio"] * numbers["damping"]
    if periods is None:
        periods_needed = CONSTANTS / rate * omega / (2.0 * math.pi) if rate > 0.0 else MOST
        periods = int(min(max(math.ceil(periods_needed), FEWEST), MOST))
    if not 1 <= periods <= MOST:
        raise ParameterError(f"periods = {periods}: give 1 to {MOST}")
    if run_up is not None:
        return _running_up(
            params[: len(model.base.parameter_names) if isinstance(model, Physical) else None],
            periods * 2.0 * math.pi / omega,
            run_up,
        )
    run = simulate(model, {"q1": 0.0, "q2": 0.0}, periods=float(periods), events=None, **numbers)
    samples, balance = run.sample(per_period=PER_PERIOD), run.balance()
    times = samples.phase / omega
    bare = _bare(times, numbers, omega)
    hits = run.codes < 2
    return StartUp(
        times, samples.cavity, samples.w, bare, run.phases[hits] / omega, np.abs(run.rows[hits, 3]),
        balance.impacts, balance.friction, balance.damping, settled(times, samples.cavity, periods), settled(times, bare, periods),
    )  # fmt: skip


def _running_up(params: np.ndarray, time: float, run_up: tuple[float, float]) -> StartUp:
    """Simulate the start with a run-up, using the declared machine `coupled_page`, whose phase may be any function of time."""
    from orbits.design.page_transients import coupled_page, page_transient

    found = page_transient(coupled_page(), params, run_up_from=run_up[0], run_up_time=run_up[1], time=time)
    q1, q2, bare = (found.states[name] for name in ("q1", "q2", "bare"))
    return StartUp(
        found.times, q1, q1 - q2, bare, found.impact_times, found.impact_speeds, float(found.impacts[-1]),
        float(found.friction[-1]), math.nan, found.settled["q1"], found.settled["bare"],
    )  # fmt: skip


def _bare(times: np.ndarray, numbers: dict[str, float], omega: float) -> np.ndarray:
    """Exact displacement of the bare oscillator from rest: q'' + eps lambda q' + q = e + share eps lambda e', e = eps G sin(Omega tau)."""
    eps = numbers["mass_ratio"]
    damping, share = eps * numbers["damping"], numbers.get("excitation", 1.0)
    size = eps * numbers["forcing"] * (1.0 + 1j * share * damping * omega)
    below = 1.0 - omega * omega + 1j * damping * omega
    if below == 0.0:  # resonance without damping: q = -size t cos(t)/2 + size sin(t)/2
        return 0.5 * size.real * (np.sin(times) - times * np.cos(times))
    answer = size / below
    steady = np.imag(answer * np.exp(1j * omega * times))
    root = complex(-0.5 * damping, math.sqrt(1.0 - 0.25 * damping * damping))
    # the free motion Re(a exp(own t)) cancels displacement and speed of the steady motion at time 0
    place, speed = float(np.imag(answer)), float(np.imag(1j * omega * answer))
    a = complex(-place, (speed - root.real * place) / root.imag)
    return steady + np.real(a * np.exp(root * times))
