"""Compare the best clearance of the worked case with a brute-force scan of a thousand clearances; both must agree within the scan's grid.

python -m tools.benchmarks.best [--values 1000] [--depth 2] [--within 8 20] [--workers 2]
"""

from __future__ import annotations

import argparse

import numpy as np

from contvines.survey import survey
from contvines.survey.survey import outcome_named
from contvines.survey.work import Job, work
from orbits.design import best
from tools.benchmarks.survey import family

OVER, WITHIN = "frequency", (7.0, 9.0)


def chosen(low, high, grid, depth):
    """Return the choice of `orbits.design.best`: the half-width [mm] with the lowest peak."""
    job = Job(family(), OVER, WITHIN, (outcome_named("peak"),), options={"depth": depth})

    def evaluate(values):
        row = work(job, 0, values)
        if row.note:
            raise ValueError(row.note)
        return row.columns

    return best(evaluate, "peak", {"half_width": (low, high)}, grid=grid)


def scanned(low, high, count, depth, workers=1):
    """Return half-widths and their peaks, from one diagram each."""
    places = np.linspace(low, high, count)
    found = survey(
        family(), {"half_width": places.tolist()}, over=OVER, within=WITHIN, depth=depth, workers=workers
    )
    return places, found["peak"]


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--values", type=int, default=1000)
    parser.add_argument("--grid", type=int, default=13)
    parser.add_argument("--depth", type=int, default=2)
    parser.add_argument("--within", type=float, nargs=2, default=(8.0, 20.0))
    parser.add_argument("--workers", type=int, default=2)
    asked = parser.parse_args()
    choice = chosen(*asked.within, asked.grid, asked.depth)
    print(
        f"best: half_width = {choice.values['half_width']:.6f} mm, peak {choice.outcome:.6f} mm", flush=True
    )
    places, peaks = scanned(*asked.within, asked.values, asked.depth, asked.workers)
    least = int(np.nanargmin(peaks))
    step = places[1] - places[0]
    print(f"scan: half_width = {places[least]:.6f} mm (steps of {step:.6f}), peak {peaks[least]:.6f} mm")
    apart = abs(choice.values["half_width"] - places[least])
    print(f"they agree within the grid: {apart <= step}, {apart / step:.2f} steps apart")


if __name__ == "__main__":
    main()
