"""Numbers of a motion that does not recur: the largest displacement of every forcing period, its mean and band, and what kind of modulation it is."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from contvines.shared.modulation import BAND, SILENT, modulation_of
from orbits.machines.stepping import PSI, TURNS
from orbits.simulation.driver import collect
from orbits.simulation.trajectory import TWO_PI, Trajectory

PERIODS = 512  # forcing periods that are looked at
PER_PERIOD = 48  # instants; events come on top
MOST_EVENTS = 400  # per period


@dataclass(frozen=True)
class Modulation:
    """Of a motion, over forcing periods.

    Attributes
    ----------
    low, mean, high : float
        Of the largest |q1| in a period, in half-widths.
    silent : float
        Share of the periods without an impact.
    """

    low: float
    mean: float
    high: float
    silent: float

    @property
    def measures(self) -> dict[str, float]:
        """By name, in half-widths."""
        return dict(zip((*BAND, SILENT), (self.low, self.mean, self.high, self.silent)))

    @property
    def kind(self) -> str:
        """See `contvines.shared.modulation.modulation_of`."""
        return modulation_of(self.measures)


def modulation(
    model: Any, engine: Any, params: np.ndarray, state: np.ndarray, periods: int = PERIODS
) -> Modulation:
    """Follow a motion of a machine with an oscillator.

    Parameters
    ----------
    model : Model
    engine : Machine
        Its stepper (`orbits.machines.catalogue.stepper`).
    params : float array (P,)
    state : float array (S,)
        On the motion; it stays as it is.
    periods : int
    """
    moved = state.copy()
    moved[TURNS] = 0.0
    begin = moved.copy()
    start = float(begin[PSI]) / TWO_PI
    seen: Any = collect(engine, moved, params, start + periods, int(MOST_EVENTS * (periods + 1)))
    run = Trajectory(model, params, engine, begin, moved.copy(), *seen)
    sample = run.sample(per_period=PER_PERIOD)
    place = np.clip(((sample.phase - sample.phase[0]) / TWO_PI).astype(int), 0, periods - 1)
    tops = np.zeros(periods)
    np.maximum.at(tops, place, np.abs(sample.cavity))
    hits = np.clip(((run.phases[run.codes < 2] - sample.phase[0]) / TWO_PI).astype(int), 0, periods - 1)
    silent = 1.0 - np.unique(hits).size / periods
    return Modulation(float(tops.min()), float(tops.mean()), float(tops.max()), float(silent))
