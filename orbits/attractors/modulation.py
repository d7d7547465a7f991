"""Numbers of a motion that does not recur: the largest displacement of every forcing period, its mean and band, and what kind of modulation it is."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from contvines.shared.modulation import BAND, SILENT, modulation_of
from orbits.flows.trajectory import TWO_PI, Trajectory
from orbits.settings import SIMULATING

PER_PERIOD = 48  # instants; events come on top


class Modulation(NamedTuple):
    """Of a motion, over forcing periods.

    Attributes
    ----------
    low, mean, high : float
        Of the largest displacement in a period, in the machine's own numbers.
    silent : float
        Share of the periods without an impact.
    """

    low: float
    mean: float
    high: float
    silent: float

    @property
    def measures(self) -> dict[str, float]:
        """By name."""
        return dict(zip((*BAND, SILENT), self))

    @property
    def kind(self) -> str:
        """See `contvines.shared.modulation.modulation_of`."""
        return modulation_of(self.measures)


def modulation(run: Trajectory) -> Modulation:
    """Of the whole forcing periods of a run."""
    periods = max(1, int(run.lasted + SIMULATING.whole))
    clocks, sizes = run.responses(PER_PERIOD)
    place = ((clocks - run.clocks[0]) / TWO_PI).astype(int)
    tops = np.full(periods, -np.inf)
    np.maximum.at(tops, place[place < periods], sizes[place < periods])
    hits = ((run.clocks[1:][run.hits] - run.clocks[0]) / TWO_PI).astype(int)
    silent = 1.0 - np.unique(hits[hits < periods]).size / periods
    return Modulation(float(tops.min()), float(tops.mean()), float(tops.max()), float(silent))
