"""Compare peaks of random surveys with brute force: simulated sweeps up, down and from random states, refined near the largest response.

    python -m tools.benchmarks.peaks [--surveys 20] [--machines 2] [--first 0] [--depth 1] [--values 121]
    python -m tools.benchmarks.peaks --design --depth 0 --surveys 30      the thirty machines of docs/design.md

Each machine of a survey must have the peak of the simulations to 1 %, or its note must state that its response is not known in the whole interval.
A peak above that of all simulations is confirmed by a simulation from the survey's motion.
"""

from __future__ import annotations

import argparse
import time
from dataclasses import dataclass
from typing import Any

import numpy as np

import contvines as cv
from contvines.coexistence.census import population_of
from contvines.command.study import read_study
from contvines.graph.stretches import highest, inside, stretches
from contvines.survey import survey
from contvines.survey.completion import complete
from orbits.attractors.search import beginning_with
from orbits.attractors.sweeping import sweep
from orbits.design import Family
from orbits.machines.physical import physical

OVER, MEASURE = "frequency", "max_abs_q1"
AGREE = 0.01  # largest relative difference of peaks
REPLAYED, LONGEST = (
    400,
    24,
)  # forcing periods of a motion that is simulated from itself, and of the longest that may recur
RANDOM = (12, 6)  # values, and random states at each


@dataclass(frozen=True)
class Drawn:
    """A survey of machines with different half-widths, and the interval of its diagrams."""

    family: Any
    half_widths: list[float]
    within: tuple[float, float]


def drawn(number: int, machines: int) -> Drawn:
    """Draw a random survey; half-widths are 0.1 to 1.5 times the linear peak."""
    rng = np.random.default_rng([28, number])
    hertz = float(rng.uniform(4.0, 15.0))
    damping = float(np.exp(rng.uniform(np.log(0.004), np.log(0.03))))
    mass, base = float(rng.uniform(1.0, 5.0)), float(np.exp(rng.uniform(np.log(0.1), np.log(3.0))))
    case = {
        "oscillator_mass": f"{mass} kg",
        "natural_frequency": f"{hertz} Hz",
        "damping_ratio": damping,
        "absorber_mass": f"{1000.0 * mass * rng.uniform(0.004, 0.02)} g",
        "restitution": float(rng.uniform(0.4, 0.85)),
        "friction": float(rng.uniform(0.01, 0.4)),
        "base_amplitude": f"{base} mm",
        "frequency": f"{hertz} Hz",
    }
    linear = base / (2.0 * damping)  # largest displacement of the bare oscillator
    half_widths = np.sort(np.exp(rng.uniform(np.log(0.1), np.log(1.5), machines))) * linear
    within = (hertz * float(rng.uniform(0.85, 0.97)), hertz * float(rng.uniform(1.03, 1.15)))
    machine = physical("coupled", {**case, "half_width": f"{half_widths[0]} mm"})
    return Drawn(Family(machine, None, over=OVER, within=within), half_widths.tolist(), within)


def designed(number: int) -> Drawn:
    """Return the machine of docs/design.md with random half-width, friction and restitution."""
    study = read_study("examples/design/machine.toml")
    rng = np.random.default_rng([34, number])
    machine = study.model.with_(
        restitution=float(rng.uniform(0.6, 0.8)), friction=float(rng.uniform(0.1085, 0.2015))
    )
    half_width = float(np.exp(rng.uniform(np.log(10.0), np.log(110.0))))
    return Drawn(Family(machine, None, over=OVER, within=study.within), [half_width], study.within)


def brute(machine: Any, within: tuple[float, float], values: int) -> tuple[float, float]:
    """Return the largest response of all simulations, and its parameter value."""
    grid = np.linspace(*within, values)
    step, seen = grid[1] - grid[0], []
    for places in (grid, grid[::-1]):
        seen += sweep(machine, OVER, places)
    generator = np.random.default_rng(7)
    for value in np.linspace(*within, RANDOM[0] + 2)[1:-1]:
        params = machine.vector_at(OVER, float(value), {})
        for _ in range(RANDOM[1]):
            start = machine.random_start(params, generator)
            seen += sweep(machine, OVER, [float(value)], start=start)
    while (
        True
    ):  # the motion with the largest response is followed to either side, in smaller and smaller steps
        top = max(seen, key=lambda row: row.measures[MEASURE])
        begin = top.detail.state
        for side in (1.0, -1.0):
            places = np.clip(top.value + side * step * np.linspace(0.0, 1.0, 6), *within)
            seen += sweep(machine, OVER, places, start=begin.copy())
        best = max(seen, key=lambda row: row.measures[MEASURE])
        if best.measures[MEASURE] < top.measures[MEASURE] * (1.0 + 1e-4):
            step /= 4.0
        if step < 1e-4 * (within[1] - within[0]):
            return best.measures[MEASURE], best.value


def confirmed(one: Drawn, half_width: float, depth: int) -> float:
    """Return the response on which a simulation settles that begins on the survey's motion near the peak."""
    seed = one.family({"half_width": half_width})
    graph = cv.diagram(seed, over=OVER, within=one.within, depth=depth)
    complete(graph, population_of(seed, OVER), 5)
    top = highest(stretches(graph))
    assert top is not None
    u, p, _ = inside(top, 0.5 * AGREE)
    orbit = top.stretch.branch.problem.orbit(u, p)
    return beginning_with(orbit, REPLAYED, LONGEST).get(MEASURE, -np.inf)


@dataclass(frozen=True)
class Verdict:
    """One machine of a survey: its peak, that of the simulations, and whether both agree."""

    number: int
    half_width: float
    peak: float
    peak_at: float
    brute: float
    brute_at: float
    covered: float
    note: str
    agrees: bool
    seconds: float

    @property
    def wrong(self) -> bool:
        """Whether simulations contradict the survey's peak."""
        return not self.agrees and not self.note


def judged(number: int, one: Drawn, depth: int, values: int) -> list[Verdict]:
    """Compute a survey and compare each machine."""
    begun = time.process_time()
    made = survey(
        one.family, {"half_width": one.half_widths}, over=OVER, within=one.within, outcomes=("peak",), depth=depth, workers=1
    )  # fmt: skip
    each = (time.process_time() - begun) / len(one.half_widths)
    found = []
    for i, half_width in enumerate(one.half_widths):
        machine, _ = one.family.machine_at({"half_width": half_width})
        largest, place = brute(machine, one.within, values)
        peak = float(made["peak"][i])
        if peak > largest * (1.0 + AGREE):
            largest = max(largest, confirmed(one, half_width, depth))
        agrees = abs(peak - largest) <= AGREE * largest
        found.append(
            Verdict(
                number, half_width, peak, float(made["peak_at"][i]), largest, place, float(made["covered"][i]),
                str(made.notes[i]), agrees, each,
            )
        )  # fmt: skip
    return found


def main() -> None:
    parser = argparse.ArgumentParser()
    parser.add_argument("--surveys", type=int, default=20)
    parser.add_argument("--machines", type=int, default=2)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--depth", type=int, default=1)
    parser.add_argument("--values", type=int, default=121)
    parser.add_argument("--design", action="store_true", help="places of the machine of docs/design.md")
    asked = parser.parse_args()
    all_ = []
    for number in range(asked.first, asked.first + asked.surveys):
        one = designed(number) if asked.design else drawn(number, asked.machines)
        for v in judged(number, one, asked.depth, asked.values):
            all_.append(v)
            said = "agrees" if v.agrees else "not known" if v.note else "WRONG"
            print(
                f"{v.number:3d} half-width {v.half_width:8.3f} mm: survey {v.peak:9.4f} at {v.peak_at:8.5f}, simulation {v.brute:9.4f} "
                f"at {v.brute_at:8.5f}, covered {v.covered:.4f}, {v.seconds:.2f} s: {said}{'; ' + v.note if v.note else ''}",
                flush=True,
            )
    known = [v for v in all_ if not v.note]
    print(
        f"{len(all_)} machines, {len(known)} known in the whole interval, {sum(v.wrong for v in all_)} wrong"
    )


if __name__ == "__main__":
    main()
