"""Random excitation with a given spectral density: signals of many harmonics with random phases, and the responses to them.

Densities are one-sided: the variance of a signal is the integral of its density over frequencies from 0 to infinity. A signal with N instants
contains all harmonics of its length T, each with the amplitude sqrt(2 S(Omega) 2 pi/T) and a uniformly distributed random phase (Shinozuka,
Deodatis, Applied Mechanics Reviews 44 (1991) 191). So every signal has exactly the given density, and linear responses have exact variances over T.
Between the instants the signal is linear (for declared machines: constant); the factor `hold` of the amplitudes compensates this interpolation.
White noise with E[xi(t) xi(t')] = 2 D delta(t - t') has the one-sided density S = 2 D/pi per radian per unit of time, or 4 D per hertz.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

import numpy as np

from orbits.contacts import HIT
from orbits.design.record import oscillator_numbers, recorded
from orbits.design.references import compliance, tuning
from orbits.flows.page.stepper import TWO_PI, Stepper
from orbits.flows.protocol import SimulationError
from orbits.integrators.expressions import variables_of
from orbits.machines.page.machine import Machine
from orbits.machines.parameters import ParameterError

if TYPE_CHECKING:
    from orbits.machines.base import Model

INSTANTS = 20  # instants of a signal per period of the highest frequency
PERIODS = 2000  # length of a record, in periods of the mean frequency of the density
RECORDS = 8  # independent records
LINES = 200  # values of a response's density; each is the mean over neighbouring harmonics
WARM = 6.0  # time constants of the oscillator before the record begins
LONGEST = 2_000_000  # most instants of a record


@dataclass(frozen=True, eq=False)
class Density:
    """A one-sided spectral density, linear between its points and 0 outside.

    Attributes
    ----------
    frequencies, values : float array (m,)
        Frequencies in radians per unit of time, ascending, and densities in (unit of the signal)^2 per radian per unit of time.
    """

    frequencies: np.ndarray
    values: np.ndarray

    def __post_init__(self) -> None:
        f, s = self.frequencies, self.values
        if f.ndim != 1 or f.shape != s.shape or f.size < 2 or not np.all(np.diff(f) > 0.0) or f[0] < 0.0:
            raise ParameterError(
                "psd: give two rows or more [frequency, density], frequencies ascending from 0 or above"
            )
        if not (np.isfinite(s).all() and np.isfinite(f).all() and s.min() >= 0.0 and s.max() > 0.0):
            raise ParameterError("psd: densities are 0 or above, and one is above 0")

    def __call__(self, omega: np.ndarray) -> np.ndarray:
        return np.interp(omega, self.frequencies, self.values, left=0.0, right=0.0)

    @property
    def variance(self) -> float:
        """Variance of the signal."""
        return float(np.trapezoid(self.values, self.frequencies))

    @property
    def step(self) -> float:
        """Time between two instants of a signal."""
        return TWO_PI / (INSTANTS * float(self.frequencies[-1]))

    def grid(self, periods: float) -> tuple[int, np.ndarray]:
        """Return the number of instants of a record and the frequencies of its harmonics.

        Parameters
        ----------
        periods : float
            Length of the record, in periods of the mean frequency.

        Raises
        ------
        ParameterError
            If there are fewer than 16 instants or more than `LONGEST`.
        """
        centre = float(np.trapezoid(self.values * self.frequencies, self.frequencies)) / self.variance
        count = 2 * math.ceil(0.5 * periods * TWO_PI / centre / self.step)
        if not 16 <= count <= LONGEST:
            raise ParameterError(f"periods = {periods:g} means {count} instants; expected 16 to {LONGEST}")
        return count, np.arange(count // 2 + 1) * TWO_PI / (count * self.step)

    def harmonics(self, omega: np.ndarray, generator: np.random.Generator) -> np.ndarray:
        """Draw the complex amplitudes of one signal at the harmonics `omega`."""
        size = np.sqrt(2.0 * self(omega) * omega[1])
        return size * np.exp(1j * generator.uniform(0.0, TWO_PI, omega.size))


def _signal(amplitudes: np.ndarray, count: int) -> np.ndarray:
    """The real signal with these amplitudes, at `count` instants."""
    return np.fft.irfft(amplitudes, count) * (0.5 * count)


@dataclass(frozen=True, eq=False)
class RandomResponse:
    """Statistics of the response over all records.

    Attributes
    ----------
    numbers : dict of (float, float)
        Name -> (mean, standard error over the records). For a machine with an oscillator: ``rms_oscillator``, ``peak_oscillator`` (mean over the
        records of the largest value), ``rms_relative``, ``impact_rate``, ``absorber_power`` (in units of M omega_0^3 b^2), ``absorber_share``,
        ``rms_bare``, ``peak_bare``, ``rms_tuned``, ``peak_tuned``. For a declared machine: ``mean_``, ``rms_`` and ``peak_`` of each state, and ``impact_rate``.
    omega : float array (k,)
        Frequencies of the densities.
    densities : dict of float array (k,)
        One-sided densities of displacements by name (``oscillator``, ``bare``, ``tuned``; for a declared machine its states).
    duration : float
        Length of one record.
    records : int
        Number of records.
    samples : dict of float array
        For a declared machine: state name -> values at all instants of all records.
    """

    numbers: dict[str, tuple[float, float]]
    omega: np.ndarray
    densities: dict[str, np.ndarray]
    duration: float
    records: int
    samples: Mapping[str, np.ndarray] = field(default_factory=dict)


def random_base(
    model: Model,
    params: np.ndarray,
    psd: Density,
    *,
    periods: float = PERIODS,
    records: int = RECORDS,
    seed: int = 0,
) -> RandomResponse:
    """Simulate a machine with an oscillator under a random base motion, and compare with the bare oscillator and a tuned absorber of the same mass.

    Parameters
    ----------
    model : Model
        A machine with an oscillator (`orbits.Coupled`).
    params : float array (P,)
    psd : Density
        Density of the base's acceleration; acceleration in half-widths times omega_0^2, frequency in omega_0.
    periods : float
        Length of one record, in periods of the mean frequency of the density.
    records, seed : int
        Number of independent records, and the seed of the random generator.

    Returns
    -------
    RandomResponse

    Raises
    ------
    ParameterError
        If the machine has no oscillator or no damping, or a number is out of range.
    """
    numbers = oscillator_numbers(model, params)
    eps, rate = numbers["mass_ratio"], numbers["mass_ratio"] * numbers["damping"]
    if not rate > 0.0:
        raise ParameterError(
            "an oscillator without damping does not settle under random excitation; give a damping above 0"
        )
    count, omega = psd.grid(periods)
    step, length = psd.step, psd.step * count
    warm = min(math.ceil(WARM * 2.0 / rate / step), 4 * count)
    places, times = np.arange(-warm, count + 1) % count, np.arange(warm + count + 1) * step
    passive = {name: transfer(omega, rate, mass) for name, mass in (("bare", 0.0), ("tuned", eps))}

    def answer(drawn: np.ndarray, signal: np.ndarray) -> tuple[Numbers, Lines]:
        simulated = recorded(model, params, times, signal[places])
        inner = (len(simulated.times) - 1) // (warm + count)
        first = warm * inner
        q, w = simulated.oscillator[first:-1], simulated.relative[first:-1]
        spectra = {"oscillator": np.fft.rfft(q[::inner]) * (2.0 / count)}
        row = {"rms_oscillator": q.var(), "peak_oscillator": np.abs(q).max(), "rms_relative": w.var()}
        for name, response in passive.items():
            spectra[name] = response * drawn
            motion = _signal(spectra[name], count)
            row |= {f"rms_{name}": motion.var(), f"peak_{name}": np.abs(motion).max()}
        row["impact_rate"] = np.count_nonzero(simulated.impact_times >= warm * step) / length
        row["absorber_power"] = (simulated.impacts + simulated.friction) / float(simulated.times[-1])
        row["absorber_share"] = simulated.absorber_share
        return row, spectra

    # the signal is linear between the instants
    return _over_records(psd, count, omega, records, seed, np.sinc(omega * step / TWO_PI) ** 2, answer)


def transfer(omega: np.ndarray, rate: float, mass: float) -> np.ndarray:
    """Complex displacement of the oscillator from its base per acceleration of the base; with `mass` > 0 it carries Den Hartog's tuned absorber."""
    x, carried = compliance(omega, rate, mass, tuning(mass))
    return -(1.0 + mass * carried) * x


def random_page(
    machine: Machine,
    params: np.ndarray,
    excited: str,
    psd: Density,
    *,
    start: Mapping[str, float] | None = None,
    periods: float = PERIODS,
    records: int = RECORDS,
    seed: int = 0,
    warm: float = 0.1,
) -> RandomResponse:
    """Simulate a declared machine while one of its parameters varies at random.

    Parameters
    ----------
    machine : Machine
    params : float array (P,)
    excited : str
        The parameter to whose value the signal is added; it is constant between instants. Gaps, surfaces and velocities of contacts must not depend on it.
    psd : Density
        Density of the parameter, in its own unit, per radian per unit of time.
    start : mapping, optional
        State in which every record begins: name -> value; other states are 0.
    periods, records, seed
        As for `random_base`.
    warm : float
        Time that is simulated before the record begins, relative to its length.

    Returns
    -------
    RandomResponse

    Raises
    ------
    ParameterError
        If the parameter sets the clock or a contact depends on it, or a number is out of range.
    SimulationError
        If `start` has an unknown state, or a simulation fails.
    """
    place = machine.place_of(excited)
    if excited == machine.phase_rate:
        raise ParameterError(f"{excited} sets the clock of {machine.name!r}; let another parameter be random")
    parameter, e = f"p_{excited}", machine.equations
    for kind in (e.gap, e.surface, e.velocity):
        for j, value in kind.items():
            if parameter in variables_of(value):
                raise ParameterError(
                    f"{excited}: {e.contacts[j].described} depends on it, which must not jump; let a force or an acceleration be random"
                )
    count, omega = psd.grid(periods)
    length, early = psd.step * count, math.ceil(warm * count)
    places, tables = np.arange(-early, count) % count, []

    def answer(drawn: np.ndarray, signal: np.ndarray) -> tuple[Numbers, Lines]:
        table, hits = _follow(machine, params, place, signal[places], psd.step, dict(start or {}))
        table = table[early:]
        tables.append(table)
        row: dict[str, float] = {}
        for j, name in enumerate(machine.states):
            x = table[:, j]
            row |= {f"mean_{name}": x.mean(), f"rms_{name}": x.var(), f"peak_{name}": np.abs(x).max()}
        if machine.equations.gap:
            row["impact_rate"] = np.count_nonzero(hits >= early * psd.step) / length
        spectra = np.fft.rfft(table - table.mean(axis=0), axis=0) * (2.0 / count)
        return row, dict(zip(machine.states, spectra.T))

    # the signal is constant between the instants
    found = _over_records(psd, count, omega, records, seed, np.sinc(omega * psd.step / TWO_PI), answer)
    return replace(found, samples=dict(zip(machine.states, np.concatenate(tables).T)))


def _follow(
    machine: Machine,
    params: np.ndarray,
    place: int,
    signal: np.ndarray,
    step: float,
    start: Mapping[str, float],
) -> tuple[np.ndarray, np.ndarray]:
    """Simulate a machine whose parameter `place` follows the signal; return the states at the instants, shape (m, n), and the times of impacts."""
    numbers = np.array(params)
    stepper = Stepper(machine, numbers)
    clock = float(machine.phase_speed(params)) * step
    unknown = set(start) - set(machine.states)
    if unknown:
        raise SimulationError(
            f"start has {', '.join(sorted(unknown))}; it may have {', '.join(machine.states)}"
        )
    stepper.start(np.array([float(start.get(name, 0.0)) for name in machine.states]), 0.0)
    table, hits = np.empty((len(signal), machine.size)), []
    for i, value in enumerate(signal):
        table[i] = stepper.state
        numbers[place] = params[place] + value
        stepper.renew(numbers)
        until = stepper.base + stepper.clock + clock
        while (event := stepper.advance(until)) is not None:
            if event[1] == HIT:
                hits.append(i * step)
    return table, np.array(hits)


Numbers = Mapping[str, float]
Lines = Mapping[str, np.ndarray]


def _over_records(
    psd: Density,
    count: int,
    omega: np.ndarray,
    records: int,
    seed: int,
    hold: np.ndarray,
    answer: Callable[[np.ndarray, np.ndarray], tuple[Numbers, Lines]],
) -> RandomResponse:
    """Draw signals, simulate the responses, and return means and standard errors over the records.

    ``answer(amplitudes, signal)`` simulates one record. It returns the record's numbers (squares for those named `rms_...`) and the complex amplitudes of
    displacements at the harmonics. The amplitudes of the signal are divided by `hold`, which compensates the interpolation between instants.
    """
    if not 2 <= records <= 10_000:
        raise ParameterError(f"records = {records}: expected 2 to 10000; error bars need two or more")
    generator, rows, lines = np.random.default_rng(seed), [], []
    for _ in range(records):
        drawn = psd.harmonics(omega, generator)
        row, spectra = answer(drawn, _signal(drawn / hold, count))
        rows.append(row)
        lines.append({name: 0.5 * np.abs(values) ** 2 / omega[1] for name, values in spectra.items()})
    numbers = {}
    for name in rows[0]:
        values = np.array([row[name] for row in rows])
        mean, error = float(values.mean()), float(values.std(ddof=1)) / math.sqrt(len(values))
        if name.startswith("rms_"):
            root = math.sqrt(mean)
            mean, error = root, error / (2.0 * root) if root > 0.0 else 0.0
        numbers[name] = (mean, error)
    low = int(np.searchsorted(omega, psd.frequencies[0]))
    top = int(np.searchsorted(omega, psd.frequencies[-1], side="right"))
    low, wide = max(low, 1), max(1, (top - low) // LINES)
    bins = [slice(low + k * wide, low + (k + 1) * wide) for k in range((top - low) // wide)]

    def thinned(values: np.ndarray) -> np.ndarray:
        return np.array([values[one].mean() for one in bins])

    densities = {name: thinned(np.mean([line[name] for line in lines], axis=0)) for name in lines[0]}
    return RandomResponse(numbers, thinned(omega), densities, psd.step * count, records)
