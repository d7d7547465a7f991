"""Check atlases of random polynomial flows: is the stability of branches right, and does the atlas contain all motions on which simulations settle?

``python -m tools.flow_fuzz COUNT [--first SEED] [--salt SALT]`` prints each finding (an error of an atlas), then the numbers of checks.

    x' = A x + p (b + B x) + Q(x, x) - |x|^2 D x        with positive D, so that all motions stay bounded

Stability of equilibria and cycles is checked by eigenvalues and by the variational equations along a simulation. Motions from random
starts are checked by their distance from the solutions of the branches at the same parameter value.
"""

from __future__ import annotations

import argparse
import time
from collections import Counter
from dataclasses import dataclass, field
from itertools import pairwise
from typing import Any

import numpy as np
from scipy.integrate import solve_ivp

import contvines as cv
from contvines import Settings
from contvines.bifurcation.locate import Segment
from contvines.branches.solutions import solutions_at
from contvines.continuation.engine import Engine, Solved

WITHIN = (-1.0, 1.0)
BOX = 2.5
EACH = 3  # solutions of each branch that are checked
PLACES, STARTS = 3, 4  # parameter values at which motions are simulated, and motions at each
SPAN = 50.0  # first duration of a simulation; it is extended to 8 and 64 times that if the motion has not settled
EDGE = 1e-5  # stability is not checked if a multiplier (eigenvalue) is nearer to the stability boundary
PIECES = 40  # initial number of simulations along a cycle, each of which begins on it
GROWTH = 1e3  # largest growth in one simulation; above it (near a saddle) the simulation is halved
CLOSED = 1e-6  # largest distance of a simulation from a cycle, relative to its size and the growth
NEAR = 2e-3  # largest distance of a settled motion from a solution, relative to its size
RETURNS = 12  # most returns to a section after which a periodic motion closes
RECURS = 1e-6  # largest difference of returns of a periodic motion, relative to its size


@dataclass
class Drawn:
    """A random flow; see the docstring of the module.

    Attributes
    ----------
    linear, by_parameter, damping : ndarray, shape (d, d)
        A, B and D.
    constant : ndarray, shape (d,)
        b.
    square : ndarray, shape (d, d, d)
        Q.
    """

    linear: np.ndarray
    by_parameter: np.ndarray
    damping: np.ndarray
    constant: np.ndarray
    square: np.ndarray

    def rates(self, x: Any, p: Any) -> Any:
        """Return f(x, p) for a state (d,) or for many states (d, m)."""
        x = np.asarray(x)
        if x.ndim == 1:
            linear = (self.linear + p * self.by_parameter) @ x + p * self.constant
            return linear + self.square @ x @ x - x @ x * (self.damping @ x)
        linear = np.tensordot(self.linear + p * self.by_parameter, x, 1) + p * self.constant[:, None]
        products = (x[:, None] * x).reshape(
            len(x) ** 2, -1
        )  # einsum would take ten times as long as the rest
        return linear + self.square.reshape(len(x), -1) @ products - (x * x).sum(axis=0) * (self.damping @ x)

    def jacobian(self, x: np.ndarray, p: float) -> np.ndarray:
        """Return df/dx at a state."""
        bent = np.einsum("ijk,k->ij", self.square + self.square.transpose(0, 2, 1), x)
        cubic = x @ x * self.damping + 2.0 * np.outer(self.damping @ x, x)
        return self.linear + p * self.by_parameter + bent - cubic

    def simulated(self, x: np.ndarray, p: float, span: float, **options: Any) -> Any:
        """Simulate a motion with scipy."""
        return solve_ivp(
            lambda t, y: self.rates(y, p), (0.0, span), x, method="DOP853", rtol=1e-9, atol=1e-10, **options
        )

    def monodromy(self, x: np.ndarray, p: float, period: float) -> tuple[np.ndarray, np.ndarray, float]:
        """Return the state after a period, its derivative by the initial state, and the largest entry of this derivative until then."""
        d = len(x)

        def rate(t: float, y: np.ndarray) -> np.ndarray:
            matrix = self.jacobian(y[:d], p) @ y[d:].reshape(d, d)
            return np.concatenate([self.rates(y[:d], p), matrix.reshape(-1)])

        start = np.concatenate([x, np.eye(d).reshape(-1)])
        run = solve_ivp(rate, (0.0, period), start, method="DOP853", rtol=1e-11, atol=1e-12).y
        return run[:d, -1], run[d:, -1].reshape(d, d), float(np.abs(run[d:]).max())


def drawn(salt: int, seed: int) -> Drawn:
    """Draw the flow of a seed; it has two to four states."""
    rng = np.random.default_rng([salt, seed])
    d = 2 + seed % 3
    return Drawn(
        linear=1.5 * rng.standard_normal((d, d)) + 0.3 * np.eye(d),
        by_parameter=rng.standard_normal((d, d)),
        damping=np.diag(rng.uniform(0.5, 1.5, d)),
        constant=0.5 * rng.standard_normal(d),
        square=0.7 * rng.standard_normal((d, d, d)),
    )


@dataclass
class Judged:
    """Checks of one flow: numbers by kind (`tried`), and errors of its atlas (`findings`)."""

    name: str
    tried: Counter[str] = field(default_factory=Counter)
    findings: list[str] = field(default_factory=list)

    def find(self, what: str) -> None:
        """Add a finding."""
        self.findings.append(f"{self.name}: {what}")


def atlas_of(flow: Drawn) -> cv.Graph:
    """Compute the atlas of a flow."""
    d = len(flow.constant)
    problem = cv.FlowProblem(flow.rates, np.zeros(d), 0.0, name="drawn")
    population = problem.population("p", box=[(-BOX, BOX)] * d)
    return cv.atlas(population, over="p", within=WITHIN, values=6, starts=8)


def judge(salt: int, seed: int) -> Judged:
    """Draw a flow, compute its atlas and check it."""
    flow, rng = drawn(salt, seed), np.random.default_rng([salt, seed, 1])
    done = Judged(f"salt {salt}, seed {seed}")
    graph = atlas_of(flow)
    for branch in graph:
        if not branch.real or len(branch) < 2 or branch.stable is None:
            continue
        for i in rng.permutation(len(branch) - 1)[:EACH]:
            if branch.stable[i] == branch.stable[i + 1]:
                _stability(flow, branch, int(i), float(rng.uniform(0.2, 0.8)), done)
    low, high = WITHIN
    for p in low + (high - low) * (np.arange(PLACES) + rng.uniform(0.0, 1.0, PLACES)) / PLACES:
        known = [
            (branch.label, _curve(solved.u, float(p), branch.problem))
            for branch in graph
            if branch.real and len(branch) > 1
            for solved in solutions_at(branch, float(p))[1]
        ]
        for start in rng.uniform(-BOX, BOX, (STARTS, len(flow.constant))):
            _settles(flow, start, float(p), known, graph, done)
    return done


def _curve(u: np.ndarray, p: float, problem: Any) -> np.ndarray:
    """Return states along a solution: one for an equilibrium, many for a cycle."""
    if problem.spectrum == "flow":
        return np.asarray(u, dtype=float)[None]
    orbit = problem.orbit(u, p)
    return orbit(np.linspace(0.0, orbit.period, 4001))


def _stability(flow: Drawn, branch: Any, i: int, place: float, done: Judged) -> None:
    """Check that a solution between two points of a branch is stable or unstable as these are."""
    stable, none = bool(branch.stable[i]), (np.zeros(0), 0.0, 0.0, 0.0)
    engine = Engine(branch.problem, WITHIN, Settings())
    first, last = (
        Solved(branch.points[k], float(branch.values[k]), branch.tangents[k], *none) for k in (i, i + 1)
    )
    found = Segment(engine, first, last).at(place)
    if found is None:
        done.tried["solutions not solved for"] += 1
        return
    u, p = found.u, float(found.p)
    said = f"{branch.label} at p = {p:.12g} is said to be {'stable' if stable else 'unstable'}"
    if branch.problem.spectrum == "flow":
        done.tried["equilibria"] += 1
        size = float(np.abs(flow.rates(u, p)).max())
        if size > 1e-8:
            done.find(f"{branch.label} at p = {p:.12g} is no equilibrium: |f| = {size:.1e}")
        growth = float(np.linalg.eigvals(flow.jacobian(u, p)).real.max())
        if abs(growth) > EDGE and (growth < 0.0) != stable:
            done.find(f"{said}, its eigenvalues go to {growth:.3g}")
        return
    orbit = branch.problem.orbit(u, p)
    done.tried["cycles"] += 1
    nodes = orbit.times[:: branch.problem.rule.degree]
    times = nodes[np.unique(np.linspace(0, len(nodes) - 1, PIECES + 1).astype(int))].tolist()
    maps, size, away = [], float(np.ptp(orbit.states, axis=0).max()), 0.0
    pieces = list(pairwise(times))[::-1]
    while pieces:
        begin, end = pieces.pop()
        state, matrix, growth = flow.monodromy(orbit(begin), p, end - begin)
        if not growth < GROWTH:
            middle = 0.5 * (begin + end)
            pieces += [(middle, end), (begin, middle)]
            continue
        away = max(away, float(np.abs(state - orbit(end)).max()) / (size * (1.0 + growth)))
        maps.append(matrix)
    largest = _largest_multiplier(maps)
    if away > CLOSED * (1.0 + orbit.period):
        done.find(f"{branch.label} at p = {p:.12g} is no cycle: a simulation is {away:.1e} away")
    elif abs(largest - 1.0) > EDGE and (largest < 1.0) != stable:
        done.find(f"{said}, its multipliers go to {largest:.8g}")


def _largest_multiplier(maps: list[np.ndarray]) -> float:
    """Largest modulus of the nontrivial multipliers; the block-cyclic matrix of the N maps has all N-th roots of the multipliers as eigenvalues."""
    count, d = len(maps), len(maps[0])
    whole = np.zeros((count * d, count * d))
    for i, matrix in enumerate(maps):
        to = (i + 1) % count * d
        whole[to : to + d, i * d : (i + 1) * d] = matrix
    with np.errstate(divide="ignore"):
        growths = count * np.log(np.sort(np.abs(np.linalg.eigvals(whole)))[count // 2 :: count])
    return float(np.exp(np.delete(growths, np.argmin(np.abs(growths))).max()))


def _settles(
    flow: Drawn,
    start: np.ndarray,
    p: float,
    known: list[tuple[str, np.ndarray]],
    graph: cv.Graph,
    done: Judged,
) -> None:
    """Check that a branch contains the motion on which a simulation settles."""
    if any(a <= p <= b for a, b in graph.settings.get("unknown") or ()):
        done.tried["motions where the atlas says that it knows of none"] += 1
        return
    done.tried["motions"] += 1
    x = start
    for span in (SPAN, 8.0 * SPAN, 64.0 * SPAN):
        x = flow.simulated(x, p, span).y[:, -1]
        if any(_on(x, curve) for _, curve in known):
            return
    run = flow.simulated(x, p, SPAN, dense_output=True)
    size = np.maximum(np.ptp(run.y, axis=1), 1e-9)
    if size.max() < 1e-6:
        done.find(f"a motion comes to rest at {x} at p = {p:.12g}, where no branch is")
        return
    normal = flow.rates(x, p)
    passes = flow.simulated(x, p, 10.0 * SPAN, events=_Section(x, normal / size**2)).y_events[0]
    for k in range(1, min(RETURNS, len(passes) - 1) + 1):
        if (np.abs(passes[-1] - passes[-1 - k]) <= RECURS * size).all():
            message = f" ({graph.message})" if graph.message else ""
            done.find(
                f"a motion settles on a cycle through {np.array2string(x, precision=8)} at p = {p:.12g}, which no branch has{message}"
            )
            return
    done.tried["motions that do not recur"] += 1


class _Section:
    """Event of scipy: the motion passes a plane in the direction of its normal."""

    terminal, direction = False, 1.0

    def __init__(self, place: np.ndarray, normal: np.ndarray) -> None:
        self.place, self.normal = place, normal

    def __call__(self, t: float, x: np.ndarray) -> float:
        return float(self.normal @ (x - self.place))


def _on(x: np.ndarray, curve: np.ndarray) -> bool:
    """Whether a state lies on an equilibrium or a cycle."""
    size = max(float(np.ptp(curve, axis=0).max()), 1e-3)
    return bool(np.linalg.norm(curve - x, axis=1).min() < NEAR * size)


def main() -> int:
    """Check all flows; return 1 if there are findings."""
    parser = argparse.ArgumentParser(description="Search for false results of flows.")
    parser.add_argument("count", type=int, help="flows")
    parser.add_argument("--first", type=int, default=0, metavar="SEED")
    parser.add_argument("--salt", type=int, default=33, help="another salt draws other flows")
    asked = parser.parse_args()
    tried: Counter[str] = Counter()
    findings, began = 0, time.process_time()
    for seed in range(asked.first, asked.first + asked.count):
        done = judge(asked.salt, seed)
        for finding in done.findings:
            print(finding, flush=True)
        if seed % 10 == 9:
            print(f"{seed + 1 - asked.first} flows, {time.process_time() - began:.0f} s", flush=True)
        tried += done.tried
        findings += len(done.findings)
    for what, count in sorted(tried.items()):
        print(f"{count:6d} {what}")
    print(
        f"{findings} findings of {asked.count} flows, {time.process_time() - began:.0f} s of processor time"
    )
    return 1 if findings else 0


if __name__ == "__main__":
    raise SystemExit(main())
