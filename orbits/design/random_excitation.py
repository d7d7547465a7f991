"""Random excitation by a spectral density: a signal of many harmonics with random phases, and the responses to it.

Densities are one-sided: the variance of a signal is the integral of its density over the frequency from 0 on. A signal of N instants has all harmonics of its
length T, each with the amplitude sqrt(2 S(Omega) 2 pi/T) and a phase drawn evenly (Shinozuka, Deodatis, Applied Mechanics Reviews 44 (1991) 191): its density
is kept exactly, and linear responses have exact variances over T. Between instants it runs linearly (of declared machines: it is held), which `hold` of the amplitudes makes up for.
White noise with E[xi(t) xi(t')] = 2 D delta(t - t') has the one-sided density S = 2 D/pi per radian a unit of time, 4 D per hertz.
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

INSTANTS = 20  # of the shortest period
PERIODS = 2000  # of a record, in radians of the middle of the density over 2 pi
RECORDS = 8
LINES = 200  # of a response's density: the mean over as many neighbouring harmonics as that takes
WARM = 6.0  # time constants that are left out
LONGEST = 2_000_000  # instants of a record


@dataclass(frozen=True, eq=False)
class Density:
    """A one-sided spectral density, linear between its points and 0 outside.

    Attributes
    ----------
    frequencies, values : float array (m,)
        Radians a unit of time, ascending; (what is excited)^2 per radian a unit of time.
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
        """Of the signal."""
        return float(np.trapezoid(self.values, self.frequencies))

    @property
    def step(self) -> float:
        """Time from one instant to the next."""
        return TWO_PI / (INSTANTS * float(self.frequencies[-1]))

    def grid(self, periods: float) -> tuple[int, np.ndarray]:
        """How many instants a record has, and its harmonics' frequencies.

        Raises
        ------
        ParameterError
            If they are too many.
        """
        centre = float(np.trapezoid(self.values * self.frequencies, self.frequencies)) / self.variance
        count = 2 * math.ceil(0.5 * periods * TWO_PI / centre / self.step)
        if not 16 <= count <= LONGEST:
            raise ParameterError(f"periods = {periods:g} means {count} instants; expected 16 to {LONGEST}")
        return count, np.arange(count // 2 + 1) * TWO_PI / (count * self.step)

    def harmonics(self, omega: np.ndarray, generator: np.random.Generator) -> np.ndarray:
        """Complex amplitudes of a draw at the harmonics."""
        size = np.sqrt(2.0 * self(omega) * omega[1])
        return size * np.exp(1j * generator.uniform(0.0, TWO_PI, omega.size))


def _signal(amplitudes: np.ndarray, count: int) -> np.ndarray:
    """The real signal with these amplitudes, at `count` instants."""
    return np.fft.irfft(amplitudes, count) * (0.5 * count)


@dataclass(frozen=True, eq=False)
class RandomResponse:
    """Statistics over records; each number is (mean, standard error over the records).

    Attributes
    ----------
    numbers : dict of (float, float)
        ``rms_oscillator``, ``peak_oscillator`` (mean of the records' largest), ``rms_relative``, ``impact_rate``, ``absorber_power`` (per unit of M omega_0^3 b^2), ``absorber_share``,
        and ``rms_bare``, ``peak_bare``, ``rms_tuned``, ``peak_tuned``; of a declared machine ``mean_``, ``rms_`` and ``peak_`` of each state, ``impact_rate``.
    omega : float array (k,)
        Frequencies of densities.
    densities : dict of float array (k,)
        One-sided densities of displacements by name (``oscillator``, ``bare``, ``tuned``; the states of a declared machine).
    duration : float
        Of one record.
    records : int
    samples : dict of float array
        Of a declared machine: all states at all instants of all records, by name.
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
    """The answer of a machine with an oscillator to a random motion of its base, beside the bare oscillator and a tuned absorber of the same mass.

    Parameters
    ----------
    model : Model
        A machine with an oscillator (`orbits.Coupled`).
    params : float array (P,)
    psd : Density
        Of the base's acceleration, in half-widths times omega_0^2, per omega_0.
    periods : float
        Of one record, of the density's mean frequency.
    records, seed : int
        Independent draws, and the seed of their generator.

    Raises
    ------
    ParameterError
        If the machine has no oscillator, or the numbers cannot be.
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
        seen = recorded(model, params, times, signal[places])
        inner = (len(seen.times) - 1) // (warm + count)
        first = warm * inner
        q, w = seen.oscillator[first:-1], seen.relative[first:-1]
        spectra = {"oscillator": np.fft.rfft(q[::inner]) * (2.0 / count)}
        row = {"rms_oscillator": q.var(), "peak_oscillator": np.abs(q).max(), "rms_relative": w.var()}
        for name, response in passive.items():
            spectra[name] = response * drawn
            motion = _signal(spectra[name], count)
            row |= {f"rms_{name}": motion.var(), f"peak_{name}": np.abs(motion).max()}
        row["impact_rate"] = np.count_nonzero(seen.impact_times >= warm * step) / length
        row["absorber_power"] = (seen.impacts + seen.friction) / float(seen.times[-1])
        row["absorber_share"] = seen.absorber_share
        return row, spectra

    # instants are joined by straight lines
    return _over_records(psd, count, omega, records, seed, np.sinc(omega * step / TWO_PI) ** 2, answer)


def transfer(omega: np.ndarray, rate: float, mass: float) -> np.ndarray:
    """Displacement of the oscillator from its base per acceleration of the base; with `mass` > 0 it carries Den Hartog's absorber."""
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
    """The answer of a declared machine one of whose parameters is random.

    Parameters
    ----------
    machine : Machine
    params : float array (P,)
    excited : str
        The parameter to whose value the signal is added; it is held from instant to instant. Gaps, surfaces and velocities of contacts must not depend on it.
    psd : Density
        Of the parameter, counted in its own unit, per radian a unit of time.
    start, periods, records, seed
        As for `random_base`; every record begins at the start.
    warm : float
        Share of a record that is simulated beforehand and left out.

    Raises
    ------
    ParameterError, SimulationError
    """
    place = machine.place_of(excited)
    if excited == machine.phase_rate:
        raise ParameterError(f"{excited} sets the clock of {machine.name!r}; let another parameter be random")
    own, e = f"p_{excited}", machine.equations
    for kind in (e.gap, e.surface, e.velocity):
        for j, value in kind.items():
            if own in variables_of(value):
                raise ParameterError(
                    f"{excited}: {e.contacts[j].described} depends on it, which must not jump; let a force or an acceleration be random"
                )
    count, omega = psd.grid(periods)
    length, early = psd.step * count, math.ceil(warm * count)
    places, kept = np.arange(-early, count) % count, []

    def answer(drawn: np.ndarray, signal: np.ndarray) -> tuple[Numbers, Lines]:
        table, hits = _follow(machine, params, place, signal[places], psd.step, dict(start or {}))
        table = table[early:]
        kept.append(table)
        row: dict[str, float] = {}
        for j, name in enumerate(machine.states):
            x = table[:, j]
            row |= {f"mean_{name}": x.mean(), f"rms_{name}": x.var(), f"peak_{name}": np.abs(x).max()}
        if machine.equations.gap:
            row["impact_rate"] = np.count_nonzero(hits >= early * psd.step) / length
        spectra = np.fft.rfft(table - table.mean(axis=0), axis=0) * (2.0 / count)
        return row, dict(zip(machine.states, spectra.T))

    # values are held from instant to instant
    found = _over_records(psd, count, omega, records, seed, np.sinc(omega * psd.step / TWO_PI), answer)
    return replace(found, samples=dict(zip(machine.states, np.concatenate(kept).T)))


def _follow(
    machine: Machine,
    params: np.ndarray,
    place: int,
    signal: np.ndarray,
    step: float,
    start: Mapping[str, float],
) -> tuple[np.ndarray, np.ndarray]:
    """States at the instants, shape (m, n), and times of impacts."""
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
    """Means and standard errors over records that are drawn.

    ``answer(amplitudes, signal)`` has numbers of a record, squares for `rms_...`, and complex amplitudes of displacements at the harmonics; amplitudes
    of the signal are divided by `hold`.
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
