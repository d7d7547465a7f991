"""Start-up: the machine at rest when its excitation begins, with the absorber and without."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from orbits.design.coupled_page import coupled_page
from orbits.design.page_transients import page_transient
from orbits.design.record import Dissipation, oscillator_numbers
from orbits.design.settling import settled
from orbits.machines.base import ParameterError
from orbits.machines.physical.machine import Physical
from orbits.simulation.runs import simulate

if TYPE_CHECKING:
    from orbits.machines.varying import Varying

FEWEST, MOST = 60, 2000  # forcing periods
CONSTANTS = 6.0  # time constants of the bare oscillator that are followed
PER_PERIOD = 80  # samples


@dataclass(frozen=True, eq=False)
class StartUp(Dissipation):
    """The first periods of a machine; lengths in half-widths, times in 1/omega_0, energies in the machine's own unit.

    Attributes
    ----------
    times, oscillator, relative, bare : float array
        Displacement of the oscillator, of it against the absorber, and of the bare oscillator.
    impact_times, impact_speeds : float array
    impacts, friction, damping : float
        Energy taken until the end.
    settled, bare_settled : float
        From when on the largest displacement of every forcing period stays within 5 % of the last ones; nan where it does not settle.
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
    """Simulate the machine from rest, the absorber in the middle, from the moment at which the excitation begins at its phase 0.

    Parameters
    ----------
    model : Model
        A machine with an oscillator.
    params : float array (P,)
    periods : int, optional
        Forcing periods, after a run-up; by default six time constants of the bare oscillator, 60 to 2000 periods.
    run_up : (float, float), optional
        Frequency at the start and time of a run-up, in omega_0 and 1/omega_0: the frequency rises linearly to the machine's own.

    Raises
    ------
    ParameterError
        If the machine has no oscillator, or the number of periods will not do.
    """
    numbers = oscillator_numbers(model, params)
    omega = float(model.phase_speed(params))
    rate = 0.5 * numbers["mass_ratio"] * numbers["damping"]
    if periods is None:
        wanted = CONSTANTS / rate * omega / (2.0 * math.pi) if rate > 0.0 else MOST
        periods = int(min(max(math.ceil(wanted), FEWEST), MOST))
    if not 1 <= periods <= MOST:
        raise ParameterError(f"periods = {periods}: give 1 to {MOST}")
    if run_up is not None:
        return _running_up(
            params[: len(model.base.parameter_names) if isinstance(model, Physical) else None],
            periods * 2.0 * math.pi / omega,
            run_up,
        )
    run = simulate(model, {"q1": 0.0, "q2": 0.0}, periods=float(periods), events=None, **numbers)
    seen, balance = run.sample(per_period=PER_PERIOD), run.balance()
    times = seen.phase / omega
    bare = _bare(times, numbers, omega)
    hits = run.codes < 2
    return StartUp(
        times, seen.cavity, seen.w, bare, run.phases[hits] / omega, np.abs(run.rows[hits, 3]),
        balance.impacts, balance.friction, balance.damping, settled(times, seen.cavity, periods), settled(times, bare, periods),
    )  # fmt: skip


def _running_up(params: np.ndarray, time: float, run_up: tuple[float, float]) -> StartUp:
    """The same in a machine file, where the phase may be any function of time."""
    found = page_transient(coupled_page(), params, run_up_from=run_up[0], run_up_time=run_up[1], time=time)
    q1, q2, bare = (found.states[name] for name in ("q1", "q2", "bare"))
    return StartUp(
        found.times, q1, q1 - q2, bare, found.impact_times, found.impact_speeds, float(found.impacts[-1]),
        float(found.friction[-1]), math.nan, found.settled["q1"], found.settled["bare"],
    )  # fmt: skip


def _bare(times: np.ndarray, numbers: dict[str, float], omega: float) -> np.ndarray:
    """q'' + eps lambda q' + q = e + share eps lambda e', e = eps G sin(Omega tau), from rest; exact."""
    eps = numbers["mass_ratio"]
    damping, share = eps * numbers["damping"], numbers.get("excitation", 1.0)
    size = eps * numbers["forcing"] * (1.0 + 1j * share * damping * omega)
    below = 1.0 - omega * omega + 1j * damping * omega
    if below == 0.0:  # resonance without damping: q = -size t cos(t)/2 + size sin(t)/2
        return 0.5 * size.real * (np.sin(times) - times * np.cos(times))
    answer = size / below
    steady = np.imag(answer * np.exp(1j * omega * times))
    own = complex(-0.5 * damping, math.sqrt(1.0 - 0.25 * damping * damping))
    # the free motion Re(a exp(own t)) that takes away the steady one's displacement and speed at the start
    place, speed = float(np.imag(answer)), float(np.imag(1j * omega * answer))
    a = complex(-place, (speed - own.real * place) / own.imag)
    return steady + np.real(a * np.exp(own * times))
