"""Check that atlases contain all attractors that brute-force simulation finds; the simulation (`witness.c`) shares no code with the package.

``python -m tools.attractors.truth paper``               friction 0.5 and 0.05, 60 amplitudes, 2000 starts each
``python -m tools.attractors.truth frequency 200``       the coupled machine, 40 frequencies, two forcings, 200 starts at each (default 2000)
``python -m tools.attractors.truth frequency 2000 3.3``  only one forcing
``python -m tools.attractors.truth absorber 20``         20 random machines (or ``cavity``, ``coupled``, ``declared``)
``python -m tools.attractors.truth absorber 5 10``       five of them, from number 10 on; the sums are printed after each

Results of the simulation are stored in the directory that the environment variable ``CONTVINES_WITNESS`` names, so that a stopped run resumes
and a change of the package does not repeat the simulation.
"""

from __future__ import annotations

import hashlib
import math
import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

import contvines as cv
from contvines.branches.solutions import solutions_at
from contvines.continuation.engine import Engine
from contvines.continuation.settings import Settings
from orbits import Absorber, Cavity, Coupled
from orbits.machines.page.loading import load_page
from tools.attractors.drawn import OPTIONS, STARTS, drawn
from tools.attractors.impacts import impacts_of, kind_of, same

SIGMAS = 3.0  # largest difference of shares in standard deviations
ENOUGH = 1000  # starts of the package for the comparison of shares
FEW_OF_A_PAGE = 100  # the same for a declared machine, whose starts are simulated one by one
SOURCE = Path(__file__).with_name("witness.c")
PAGE = Path(__file__).resolve().parents[2] / "examples" / "machines" / "absorber.py"
NAMED = {"chaotic", "quasi-periodic", "slow", "chatter"}  # kinds of motions without a period
PILED = 1000  # number of events by which the witness marks a cycle with accumulating impacts
NEAR = 0.01  # largest distance of a non-periodic attractor of the atlas from the simulated value, relative to the interval


@dataclass
class Met:
    """Result of the witness at one value; each attractor is (periods, impacts, starts, rows of wall, phase and B, whether impacts accumulate)."""

    value: float
    attractors: list[tuple[int, int, int, np.ndarray, bool]]
    stuck: int
    wandering: int
    chaotic: int


@dataclass
class Tally:
    """Numbers of attractors on an atlas and missing ones, and of shares of starts that differ."""

    met: int = 0
    missing: int = 0
    share: float = 0.0
    missing_share: float = 0.0
    unnamed: int = 0
    kinds: int = 0
    lost: int = 0
    compared: int = 0
    apart: int = 0

    def __add__(self, other: Tally) -> Tally:
        return Tally(*(a + b for a, b in zip(vars(self).values(), vars(other).values(), strict=True)))

    def __str__(self) -> str:
        return (
            f"{self.met - self.missing} of {self.met} attractors, {1.0 - self.missing_share / max(self.share, 1e-300):.4%} of starts, "
            f"{self.kinds - self.lost} of {self.kinds} kinds, "
            f"{self.unnamed} wandering values without a name; {self.apart} of {self.compared} shares beyond {SIGMAS:g} sigma"
        )


@cache
def compiled() -> str:
    """Compile the witness; return its path."""
    target = Path(tempfile.mkdtemp()) / "witness"
    subprocess.run(["gcc", "-O3", "-o", str(target), str(SOURCE), "-lm"], check=True)
    return str(target)


def _told(program: str, arguments: Sequence[str], lines: str) -> str:
    """Return the output of the witness; it is stored in the directory `CONTVINES_WITNESS`, if given, until the witness or its input changes."""
    kept = os.environ.get("CONTVINES_WITNESS")
    key = hashlib.sha256("\n".join((SOURCE.read_text(), *arguments, lines)).encode()).hexdigest()
    file = Path(kept, key[:32]) if kept else None
    if file is not None and file.exists():
        return file.read_text()
    done = subprocess.run([program, *arguments], input=lines, capture_output=True, text=True, check=True)
    if file is not None:
        file.parent.mkdir(parents=True, exist_ok=True)
        file.with_suffix(".part").write_text(done.stdout)
        file.with_suffix(".part").replace(file)
    return done.stdout


def witness(
    machine: Any,
    over: str,
    values: Sequence[float],
    starts: int,
    seed: int = 1,
    transient: float = 200.0,
    tries: int = 5,
) -> list[Met]:
    """Simulate random starts from the machine's box with the witness, until they recur."""
    first = f"{int(isinstance(machine, Coupled))} {starts} {seed}"
    box, program = machine.population(over).box, compiled()
    text = "".join(
        _told(
            program,
            (str(transient), "1e-8", str(tries)),
            f"{first}\n{' '.join(map(repr, _numbers(machine, over, float(p), box(p))))}",
        )
        for p in values
    )
    rows = iter(text.splitlines())
    met = []
    for row, p in zip(rows, values, strict=False):
        count, stuck, wandering, chaotic = map(int, row.split()[2:])
        found = []
        for _ in range(count):
            cells = next(rows).split()
            periods, hits, events, number = map(int, cells[:4])
            impacts = np.array(cells[6:], dtype=float).reshape(-1, 3)
            found.append((periods, hits, number, impacts, events >= PILED))
        met.append(Met(float(p), found, stuck, wandering, chaotic))
    return met


def _numbers(machine: Any, over: str, p: float, box: np.ndarray) -> list[float]:
    """Return the input of the witness at one value, by the formulas of the machine's documentation."""
    of = {
        n: float(x)
        for n, x in zip(machine.parameter_names, machine.vector_at(over, p, {over: p}), strict=True)
    }
    rate = float(box[2, 1])
    if isinstance(machine, Coupled):
        names = ("forcing", "frequency", "damping", "mass_ratio", "restitution", "friction", "gravity")
        return [of.get("excitation", 0.0), *(of[n] for n in names), rate, float(box[3, 1])]
    weight = (1.0 + of["mass_ratio"]) * of["gravity"]
    if isinstance(machine, Absorber):
        r, a = of["restitution"], weight * of["friction"]
        return [of["amplitude"], r, r, a, a, 0.0, of["frequency"], 1.0, 1.0, rate]
    level, along = weight * math.cos(of["slope"]), weight * math.sin(of["slope"])
    frictions = [level * of["friction_left"], level * of["friction_right"]]
    restitutions = [of["restitution_left"], of["restitution_right"]]
    distances = [of["distance_left"], of["distance_right"]]
    return [of["amplitude"], *restitutions, *frictions, along, of["frequency"], *distances, rate]


def on_atlas(graph: cv.Graph, met: Sequence[Met], mirror: bool = True, say: Any = print) -> Tally:
    """Search a graph for all attractors of the witness on stable real branches.

    Attractors at different values with the same periods and the same order of walls are one kind; a kind counts as lost if one of them is missing.
    """
    tally, engines = Tally(), {}
    kinds: dict[tuple, bool] = {}
    low, high = graph.within
    for here in met:
        stable = [
            b
            for b in graph
            if b.real
            and any(first - 1e-9 <= here.value <= last + 1e-9 for first, last in b.stable_intervals())
        ]
        total = sum(n for _, _, n, *_ in here.attractors) + here.stuck + here.wandering
        known = [row for b in stable for row in _impacts_on(b, here.value, graph.within, engines)]
        resting = {str(b.description.get("word", "")) for b in stable}
        named = {a.kind for a in graph.attractors if abs(a.value - here.value) < NEAR * (high - low)}
        for periods, hits, number, row, piles in here.attractors:
            share = number / total
            on = (
                "chatter" in named  # a motion with infinitely many impacts has no word
                if piles
                else any(same(row, one, mirror) for one in known)
                if hits
                else any(not set(w) & set("LR") for w in resting)
            )
            tally += Tally(1, not on, share, 0.0 if on else share)
            kind = kind_of(periods, row, piles, mirror)
            kinds[kind] = kinds.get(kind, False) or not on
            if not on:
                say(
                    f"missing at {here.value:.8g}: {hits} impacts in {periods} periods, share {share:.4f} of the starts"
                )
        if here.wandering:
            share, on = here.wandering / total, bool(named & NAMED)
            tally += Tally(unnamed=not on, share=share, missing_share=0.0 if on else share)
            kinds[("wanders",)] = kinds.get(("wanders",), False) or not on
            if not on:
                say(f"not named near {here.value:.8g}: share {share:.4f} of the starts wanders")
    return tally + Tally(kinds=len(kinds), lost=sum(kinds.values()))


def shares(
    population: Any, met: Sequence[Met], starts: int, mirror: bool, say: Any = print, drawing: Any = None
) -> Tally:
    """Compare the shares of starts of the package with those of the witness; `drawing` is the population with the witness's box of starts, if different."""
    tally = Tally()
    for here in met:
        drawn_starts = (drawing or population).starts(starts, 99, here.value)
        motions, index, _ = population.settle(drawn_starts, here.value)
        own = [(m, int(np.sum(index == k))) for k, m in enumerate(motions) if m.problem is not None]
        total = sum(n for _, _, n, *_ in here.attractors) + here.stuck + here.wandering
        for periods, hits, number, row, piles in here.attractors:
            if piles:
                ours = sum(int(np.sum(index == k)) for k, m in enumerate(motions) if m.kind == "chatter")
            elif hits:
                ours = sum(
                    n
                    for m, n in own
                    if m.kind == "periodic"
                    and same(row, impacts_of(m.problem.orbit(m.u, here.value)), mirror)
                )
            else:
                ours = sum(
                    n
                    for m, n in own
                    if m.kind in ("sliding", "periodic")
                    and m.periods == periods
                    and not set(m.word) & set("LR")
                )
            one, other = number / total, ours / starts
            least = 1.0 / min(total, starts)  # lower bound, because a small sample may have the share 0 or 1
            both = float(np.clip((number + ours) / (total + starts), least, 1.0 - least))
            error = math.sqrt(both * (1.0 - both) * (1.0 / total + 1.0 / starts))
            beyond = abs(one - other) > SIGMAS * max(error, 1e-12)
            tally += Tally(compared=1, apart=beyond)
            if beyond:
                say(
                    f"shares at {here.value:.8g}: {one:.4f} and {other:.4f} ({hits} impacts in {periods} periods)"
                )
    return tally


def listed_twice(graph: cv.Graph) -> list[str]:
    """Return attractors that are listed more often at one value than their branch has stable solutions there."""
    seen: dict[tuple, int] = {}
    for a in graph.attractors:
        if a.branch is not None:
            key = (a.value, a.starts, a.branch, a.word, a.periods)
            seen[key] = seen.get(key, 0) + 1
    return [
        f"{word} on {label} at {value}"
        for (value, _, label, word, _), n in seen.items()
        if n > 1 and n > _stable_on(graph[label], value)
    ]


def _stable_on(branch: Any, p: float) -> int:
    """Number of stable solutions of a branch at a value."""
    engine, solved = solutions_at(branch, p)
    return sum(bool((np.abs(engine.multipliers(one.row)) < 1.0).all()) for one in solved)


def _impacts_on(branch: Any, p: float, within: tuple[float, float], engines: dict) -> Iterator[np.ndarray]:
    """Yield the impacts of each orbit of a branch at a value."""
    engine = engines.setdefault(branch.label, Engine(branch.problem, within, Settings()))
    gaps = branch.values - p
    for i in np.flatnonzero((gaps[:-1] * gaps[1:] <= 0.0) & (gaps[:-1] != gaps[1:])):
        t = gaps[i] / (gaps[i] - gaps[i + 1])
        solved = engine.at_value(branch.points[i] * (1.0 - t) + branch.points[i + 1] * t, p)
        if solved is not None:
            yield impacts_of(branch.problem.orbit(solved.u, p))


def studied(
    machine: Any,
    over: str,
    within: tuple[float, float],
    at: Sequence[float],
    count: int,
    page: bool = False,
    **options: Any,
) -> Tally:
    """Compare the atlas of a machine (with `page`: of the same machine in a machine file) with the witness, and print the result."""
    begin = time.process_time()
    population = machine.population(over)
    if page:
        of = {
            name: getattr(machine, name)
            for name in ("restitution", "friction", "gravity", "mass_ratio", "frequency")
        }
        population = load_page(PAGE, "machine").population(over, **of)
    graph = cv.atlas(population, within=within, **options)
    seconds = time.process_time() - begin
    mirror = not isinstance(machine, Cavity)
    met = witness(machine, over, at, count, tries=4 if isinstance(machine, Coupled) else 5)
    tally = on_atlas(graph, met, mirror) + shares(
        population,
        met,
        min(count, FEW_OF_A_PAGE if page else ENOUGH),
        mirror,
        drawing=machine.population(over),
    )
    twice = listed_twice(graph)
    print(f"{tally}; {len(graph)} branches in {seconds:.1f} s; listed twice: {twice or 'none'}", flush=True)
    return tally


def main() -> None:
    """Run one of the comparisons in the module's docstring."""
    what = sys.argv[1] if len(sys.argv) > 1 else "paper"
    tally = Tally()
    if what == "paper":
        middles = 0.2 + 1.1 * (np.arange(60) + 0.5) / 60
        for friction in (0.5, 0.05):
            machine = Absorber(restitution=0.76, friction=friction, gravity=0.211, mass_ratio=0.006)
            tally += studied(machine, "amplitude", (0.2, 1.3), list(middles), 2000)
    elif what == "frequency":
        starts = int(sys.argv[2]) if len(sys.argv) > 2 else 2000
        for forcing in map(float, sys.argv[3:]) if len(sys.argv) > 3 else (2.47, 3.3):
            machine = Coupled(
                forcing=forcing, damping=1.0, mass_ratio=0.006, restitution=0.76, friction=0.5, gravity=0.211
            )
            values = np.linspace(0.9705, 1.0295, 40)
            tally += studied(machine, "frequency", (0.97, 1.03), list(values), starts, depth=0, starts=64)
    else:
        count = int(sys.argv[2]) if len(sys.argv) > 2 else 20
        first = int(sys.argv[3]) if len(sys.argv) > 3 else 0
        for i in range(first, first + count):
            machine, over, (low, high) = drawn(what, i)
            values = low + (high - low) * np.sort(np.random.default_rng(i).random(6))
            print(f"{what} {i}", end=": ", flush=True)
            tally += studied(
                machine, over, (low, high), list(values), STARTS[what], what == "declared", **OPTIONS[what]
            )
            print(f"   so far: {tally}", flush=True)
    print(tally)


if __name__ == "__main__":
    main()
