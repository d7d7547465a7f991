"""Compare random machine files with an independent integration of Newton's laws: `python -m tools.machine_files COUNT [--first SEED] [--salt SALT]`.

A machine has one to three bodies on springs (some of them stiffening) and dampers between each other and to the ground. A force or moving walls
excite it. It has stops against the ground, between bodies or in a moving cavity, and dry friction on the ground or a belt. The independent
integration uses scipy's DOP853 from event to event; events are located by sampling and Brent's method, friction follows Coulomb's
inequality, impacts Newton's law.

Two things are compared: letters and times of the first events of simulations, and whether orbits on real branches close.
"""

from __future__ import annotations

import argparse
import warnings
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from scipy.integrate import DOP853
from scipy.optimize import brentq

import contvines as cv
from orbits import DryFriction, Machine, Wall
from orbits.flows.protocol import SimulationError
from orbits.symbols import cos

EXACT = {"rtol": 1e-12, "atol": 1e-13}
SAMPLES = 24  # samples of each integration step at which events are sought
# AGREE: largest difference of times; PUSH: perturbation of a start that measures its growth;
# SLOW: speed below which impacts accumulate if the wall is pressed by more than HARD
AGREE, PUSH, SLOW, HARD = (
    1e-6,
    1e-9,
    1e-3,
    0.05,
)
EVENTS, MOST = 24, 10**6  # events of a motion that are compared; largest number of events of a run
TRIES = 30  # random starts from which an attractor is sought


@dataclass
class Stop:
    """A wall for body `a` on its side `side`: body `b`, the ground, or a cavity that moves as `shake` cos(phase)."""

    letter: str
    a: int
    b: int | None
    side: int
    clearance: float
    restitution: float
    shake: float = 0.0


@dataclass
class Drawn:
    """Data of a machine; lists have one entry per body, `chain` has one (stiffness, damping) per neighbouring pair."""

    mass: list[float]
    ground: list[float]
    stiffening: list[float]
    damper: list[float]
    chain: list[tuple[float, float]]
    forcing: list[float]
    frequency: float
    limit: list[float]
    belt: list[float]
    stops: list[Stop] = field(default_factory=list)

    @property
    def n(self) -> int:
        """Number of bodies."""
        return len(self.mass)


def draw(salt: int, seed: int) -> Drawn:
    """Draw the machine of a seed."""
    rng = np.random.default_rng([salt, seed])
    n = int(rng.choice([1, 2, 2, 3]))

    def some(chance: float, low: float, high: float) -> list[float]:
        return [float(rng.uniform(low, high)) if rng.random() < chance else 0.0 for _ in range(n)]

    drawn = Drawn(
        mass=[float(rng.uniform(0.1, 2.0)) for _ in range(n)],
        ground=some(0.7, 0.3, 3.0),
        stiffening=some(0.2, 0.2, 2.0),
        damper=some(0.8, 0.02, 0.4),
        chain=[(float(rng.uniform(0.2, 2.0)), float(rng.uniform(0.0, 0.2))) for _ in range(n - 1)],
        forcing=some(0.6, 0.3, 2.0),
        frequency=float(rng.uniform(0.5, 2.0)),
        limit=some(0.5, 0.05, 0.8),
        belt=some(0.15, -0.8, 0.8),
    )
    shake = float(rng.uniform(0.3, 1.2)) if rng.random() < 0.4 else 0.0
    if not any(drawn.forcing) and not shake:
        drawn.forcing[0] = 1.0
    letters = iter("LRABCDEF")
    for i in range(n):
        rides = shake if rng.random() < 0.6 else 0.0
        for side in (-1, 1):
            if rng.random() < 0.6 or (i == 0 and side == 1):
                drawn.stops.append(
                    Stop(
                        next(letters),
                        i,
                        None,
                        side,
                        float(rng.uniform(0.3, 1.2)),
                        float(rng.uniform(0.3, 0.95)),
                        rides,
                    )
                )
    for i in range(n - 1):
        if rng.random() < 0.7:
            drawn.stops.append(
                Stop(next(letters), i, i + 1, 1, float(rng.uniform(0.4, 1.2)), float(rng.uniform(0.3, 0.95)))
            )
    return drawn


# ---------------------------------------------------------------------- as a machine file
def machine(d: Drawn) -> Machine:
    """Declare the machine as in a machine file."""
    n = d.n

    def motion(state: Any, phase: Any, p: Any, contact: Any) -> Any:
        x, v = state[:n], state[n:]
        rates = list(v)
        for i in range(n):
            force = p.forcing * d.forcing[i] * cos(phase) - d.ground[i] * x[i] - d.damper[i] * v[i]
            if d.stiffening[i]:
                force = force - d.stiffening[i] * x[i] * x[i] * x[i]
            for j, k in ((i - 1, i - 1), (i + 1, i)):
                if 0 <= j < n:
                    force = force + d.chain[k][0] * (x[j] - x[i]) + d.chain[k][1] * (v[j] - v[i])
            if d.limit[i]:
                force = force + getattr(contact, f"floor{i}")
            rates.append(force / d.mass[i])
        return rates

    def wall(s: Stop) -> Wall:
        def gap(state: Any, phase: Any, p: Any) -> Any:
            other = (
                s.shake * cos(phase) if s.b is None and s.shake else (state[s.b] if s.b is not None else 0.0)
            )
            return s.clearance - s.side * (state[s.a] - other)

        push = {f"v{s.a}": -s.side / d.mass[s.a]}
        if s.b is not None:
            push[f"v{s.b}"] = s.side / d.mass[s.b]
        return Wall(s.letter, gap, push, s.restitution)

    def friction(i: int) -> DryFriction:
        texts = (f"t{i}", f"s{i}", f"u{i}")
        return DryFriction(f"floor{i}", lambda state, phase, p: state[n + i] - d.belt[i], d.limit[i], texts)

    return Machine(
        name="drawn",
        states=(*(f"x{i}" for i in range(n)), *(f"v{i}" for i in range(n))),
        parameters={"forcing": 1.0, "frequency": d.frequency},
        phase_rate="frequency",
        motion=motion,
        contacts=[*(wall(s) for s in d.stops), *(friction(i) for i in range(n) if d.limit[i])],
    )


# ---------------------------------------------------------------------- independent integration
class Witness:
    """One motion, integrated from event to event independently of the package."""

    def __init__(self, d: Drawn, forcing: float, frequency: float, phase: float, state: np.ndarray) -> None:
        self.d, self.forcing, self.frequency, self.phase = d, forcing, frequency, phase
        self.time, self.y = 0.0, np.array(state, dtype=float)
        n = d.n
        sliding = self.y[n:] - np.array(d.belt)
        self.slides = [0 if not d.limit[i] else int(np.sign(sliding[i])) for i in range(n)]
        for i in range(n):
            if d.limit[i] and self.slides[i] == 0:
                self._settle(i)
        self.events: list[tuple[str, float]] = []
        self.held: list[int] = []  # stops in lasting contact

    def force(self, i: int, t: float, y: np.ndarray) -> float:
        """Force of springs, dampers and the excitation on one body."""
        d, n = self.d, self.d.n
        x, v = y[:n], y[n:]
        f = self.forcing * d.forcing[i] * np.cos(self.phase + self.frequency * t)
        f += -d.ground[i] * x[i] - d.damper[i] * v[i] - d.stiffening[i] * x[i] ** 3
        if i:
            k, c = d.chain[i - 1]
            f += k * (x[i - 1] - x[i]) + c * (v[i - 1] - v[i])
        if i < n - 1:
            k, c = d.chain[i]
            f += k * (x[i + 1] - x[i]) + c * (v[i + 1] - v[i])
        return float(f)

    def rates(self, t: float, y: np.ndarray) -> np.ndarray:
        """Return velocities and accelerations."""
        d, n = self.d, self.d.n
        out = np.empty(2 * n)
        out[:n] = y[n:]
        for i in range(n):
            if d.limit[i] and self.slides[i] == 0:
                out[n + i] = 0.0
            else:
                out[n + i] = (self.force(i, t, y) - d.limit[i] * self.slides[i]) / d.mass[i]
        for k in self.held:
            s = d.stops[k]
            if s.b is None:
                out[n + s.a] = -s.shake * self.frequency**2 * np.cos(self.phase + self.frequency * t)
            else:
                both = d.mass[s.a] * out[n + s.a] + d.mass[s.b] * out[n + s.b]
                out[n + s.a] = out[n + s.b] = both / (d.mass[s.a] + d.mass[s.b])
        return out

    def push(self, k: int, t: float, y: np.ndarray) -> float:
        """Acceleration with which the gap of a stop would close without its force; positive while the stop presses."""
        held, n, s = self.held, self.d.n, self.d.stops[k]
        self.held = [other for other in held if other != k]
        free = self.rates(t, y)[n:]
        self.held = held
        wall = -s.shake * self.frequency**2 * np.cos(self.phase + self.frequency * t)
        return float(s.side * (free[s.a] - (wall if s.b is None else free[s.b])))

    def gap(self, s: Stop, t: float, y: np.ndarray) -> tuple[float, float]:
        """Return the gap of a stop and its rate."""
        n, angle = self.d.n, self.phase + self.frequency * t
        if s.b is not None:
            other, rate = y[s.b], y[n + s.b]
        else:
            other, rate = s.shake * np.cos(angle), -s.shake * self.frequency * np.sin(angle)
        return s.clearance - s.side * (y[s.a] - other), -s.side * (y[n + s.a] - rate)

    def _settle(self, i: int) -> None:
        """Let a body at rest stick, or begin to slide in the direction of the force."""
        f = self.force(i, self.time, self.y)
        self.slides[i] = 0 if abs(f) <= self.d.limit[i] else int(np.sign(f))

    def watched(self) -> list[tuple[str, Callable[[float, np.ndarray], float], tuple[str, int]]]:
        """Return (letter, function, (kind, index)) of all possible events; an event is a decrease of the function through zero."""
        d, n = self.d, self.d.n
        out: list[Any] = []
        for k, s in enumerate(d.stops):
            if k in self.held:
                out.append((f"{s.letter})", lambda t, y, k=k: self.push(k, t, y), ("release", k)))
            else:
                out.append((s.letter, lambda t, y, s=s: self.gap(s, t, y)[0], ("hit", k)))
        for i in range(n):
            if not d.limit[i]:
                continue
            if i in self.carried() and not d.belt[i] and not self.d.stops[self.carried()[i]].shake:
                continue  # at rest on a wall at rest
            if self.slides[i]:
                out.append(("", lambda t, y, i=i, a=self.slides[i]: a * (y[n + i] - d.belt[i]), ("rest", i)))
            else:
                out.append((f"u{i}", lambda t, y, i=i: d.limit[i] - abs(self.force(i, t, y)), ("slip", i)))
        return out

    def carried(self) -> dict[int, int]:
        """Return body -> stop, for stops against ground or cavity in lasting contact."""
        return {self.d.stops[k].a: k for k in self.held if self.d.stops[k].b is None}

    def run(self, until: float, most: int = MOST) -> bool:
        """Integrate until a time or a number of events; return False if the motion can no longer be compared (accumulating impacts)."""
        while self.time < until and len(self.events) < most:
            watched = self.watched()
            solver = DOP853(self.rates, self.time, self.y, until, max_step=0.2 / self.frequency, **EXACT)
            first = None
            while first is None and solver.status == "running":
                solver.step()
                dense, times = solver.dense_output(), np.linspace(solver.t_old, solver.t, SAMPLES + 1)
                states = dense(times).T
                for letter, function, what in watched:
                    values = [function(t, y) for t, y in zip(times, states)]
                    for a, b, fa, fb in zip(times, times[1:], values, values[1:]):
                        # a function that begins at zero and leaves it is no event
                        if fb < 0.0 and (fa > 0.0 or (fa > -1e-9 and a > self.time)):
                            at = (
                                a
                                if fa <= 0.0
                                else brentq(lambda t, f=function, at=dense: f(t, at(t)), a, b, xtol=1e-15)
                            )
                            if first is None or at < first[0]:
                                first = (at, dense(at), letter, what)
                            break
                if first is None and any(
                    self.gap(s, solver.t, solver.y)[0] < -AGREE
                    for k, s in enumerate(self.d.stops)
                    if k not in self.held
                ):
                    return False  # two impacts between two samples
            if first is None:
                self.time, self.y = until, solver.y
                return True
            self.time, self.y = first[0], np.array(first[1])
            if not self._happen(first[2], *first[3]):
                return False
        return True

    def _hold(self, k: int, rate: float) -> bool:
        """Begin lasting contact after accumulating impacts, if the stop is pressed; return False if this case is not compared."""
        d, n, y, s = self.d, self.d.n, self.y, self.d.stops[k]
        if self.push(k, self.time, y) < HARD or any(
            {s.a, s.b} & {d.stops[j].a, d.stops[j].b} - {None} for j in self.held
        ):
            return False
        share = 1.0 if s.b is None else d.mass[s.b] / (d.mass[s.a] + d.mass[s.b])
        y[n + s.a] += s.side * rate * share
        if s.b is not None:
            y[n + s.b] -= s.side * rate * (1.0 - share)
            if d.limit[s.a] or d.limit[s.b]:
                return False
        elif d.limit[s.a]:
            self.slides[s.a] = int(np.sign(y[n + s.a] - d.belt[s.a])) if s.shake or d.belt[s.a] else 0
        self.held.append(k)
        self.events.append((f"({s.letter}", self.time))
        return self.push(k, self.time, y) > 0.0

    def _let_go(self, k: int) -> None:
        """End lasting contact."""
        s = self.d.stops[k]
        self.held.remove(k)
        self.events.append((f"{s.letter})", self.time))
        if s.b is None and self.d.limit[s.a] and abs(self.y[self.d.n + s.a] - self.d.belt[s.a]) < AGREE:
            self.y[self.d.n + s.a] = self.d.belt[s.a]
            self._settle(s.a)
            if self.slides[s.a] == 0:
                self.events.append((f"s{s.a}", self.time))

    def _turned_by(self, k: int, i: int) -> bool:
        """Let the velocity of a body in lasting contact pass that of its belt."""
        self.slides[i] = -self.slides[i]
        if self.push(k, self.time, self.y) >= 0.0:
            self.events.append((f"t{i}", self.time))
        else:
            self._let_go(k)
        return True

    def _happen(self, letter: str, what: str, k: int) -> bool:
        """Apply an event to the state; return False if the motion can no longer be compared."""
        d, n, y = self.d, self.d.n, self.y
        if what == "hit":
            s = d.stops[k]
            rate = self.gap(s, self.time, y)[1]
            if abs(rate) < SLOW:
                return self._hold(k, rate)
            if any({s.a, s.b} & {d.stops[j].a, d.stops[j].b} - {None} for j in self.held):
                return False  # impact on a body in lasting contact
            weight = 1.0 / d.mass[s.a] + (0.0 if s.b is None else 1.0 / d.mass[s.b])
            blow = -(1.0 + s.restitution) * rate / weight
            y[n + s.a] -= s.side * blow / d.mass[s.a]
            if s.b is not None:
                y[n + s.b] += s.side * blow / d.mass[s.b]
            for i in (s.a, s.b):
                if i is not None and d.limit[i]:
                    self.slides[i] = int(np.sign(y[n + i] - d.belt[i]))
        elif what == "rest":
            y[n + k] = d.belt[k]
            came = self.slides[k]
            if k in self.carried():
                return self._turned_by(self.carried()[k], k)
            if any(k in (d.stops[j].a, d.stops[j].b) for j in self.held):
                return False
            self._settle(k)
            if self.slides[k] == came:  # the velocity only touches zero
                return False
            letter = f"s{k}" if self.slides[k] == 0 else f"t{k}"
        elif what == "release":
            self._let_go(k)
            return True
        else:
            self.slides[k] = int(np.sign(self.force(k, self.time, y)))  # the reserve of friction vanishes
        self.events.append((letter, self.time))
        for i in range(n):  # a damper transmits the velocity jump of a neighbouring body as a force
            if (
                d.limit[i]
                and self.slides[i] == 0
                and abs(self.force(i, self.time, y)) > d.limit[i] * (1.0 + 1e-9)
            ):
                self.slides[i] = int(np.sign(self.force(i, self.time, y)))
                self.events.append((f"u{i}", self.time))
        return True


def compared(d: Drawn, m: Machine, rng: np.random.Generator) -> str:
    """Compare the first events of one motion; return a sentence if they differ, else an empty text."""
    n = d.n
    for _ in range(200):
        state = np.concatenate([rng.uniform(-0.3, 0.3, n), rng.uniform(-1.0, 1.0, n)])
        phase = float(rng.uniform(0.0, 2 * np.pi))
        begin = Witness(d, 1.0, d.frequency, phase, state)
        if all(begin.gap(s, 0.0, state)[0] > 0.01 for s in d.stops):
            break
    else:
        return ""
    period = 2 * np.pi / d.frequency
    start = {
        **{f"x{i}": state[i] for i in range(n)},
        **{f"v{i}": state[n + i] for i in range(n)},
        "phase": phase,
    }
    try:
        ours = m.simulate(start, periods=40.0, events=4 * EVENTS)
    except SimulationError as error:
        return f"SimulationError: {error}"
    begin.run(40.0 * period, EVENTS)
    pushed = Witness(d, 1.0, d.frequency, phase, state + PUSH * rng.standard_normal(2 * n))
    pushed.run(40.0 * period, EVENTS)
    mine = [(str(a), (float(t) - phase) / d.frequency) for a, t in zip(ours.letters, ours.clocks[1:])]
    allowed = AGREE
    for k, ((letter, time), (other, near)) in enumerate(zip(begin.events, pushed.events)):
        growth = abs(time - near) / PUSH
        if letter[0] == "(":  # programs end accumulating impacts at different sizes
            allowed = 300.0 * AGREE
            while k < len(mine) and mine[k][0] != letter and mine[k][1] < time + 100.0 * SLOW:
                del mine[k]
            if k < len(mine) and mine[k][0] == letter and abs(mine[k][1] - time) < 100.0 * SLOW:
                continue
        if letter != other or growth > 1e4:
            return ""  # later events depend too strongly on rounding
        if k >= len(mine):
            return f"event {k}: {letter} at {time:.9f}; the simulator has stopped ({ours.ended})"
        if mine[k][0] != letter or abs(mine[k][1] - time) > allowed * (1.0 + growth * 1e-2):
            return f"event {k}: {letter} at {time:.9f}; the simulator has {mine[k][0]} at {mine[k][1]:.9f} (growth {growth:.1f})"
    return ""


def orbits_of(m: Machine, rng: np.random.Generator) -> list[Any]:
    """Return real orbits from a small diagram that begins at an attractor."""
    attractor = None
    for _ in range(TRIES):
        with suppress(SimulationError):  # bodies overlap at this start
            attractor = m.attractor(m.random_start(m.vector(), rng))
            break
    if attractor is None or attractor.orbit is None or not len(attractor.orbit.word):
        return []
    graph = cv.diagram(
        attractor.orbit, over="forcing", within=(0.8, 1.25), depth=1, settings=cv.Settings(max_branches=6)
    )
    found = []
    for branch in graph.branches.values():
        for i in np.flatnonzero(np.asarray(branch.real))[:: max(1, len(branch) // 3)]:
            found.append(branch.orbit(int(i)))
    return found


def returning(d: Drawn, orbit: Any) -> str:
    """Check by independent integration that an orbit closes; return a sentence if not, else an empty text."""
    nodes, lasts = np.asarray(orbit.nodes), orbit.durations
    growth = float(np.abs(orbit.multipliers).max(initial=0.0))
    if not lasts.min() > SLOW or not orbit.margin > SLOW or growth > 1e3:
        return ""
    first = int(lasts.argmax())
    at = dict(zip(orbit.model.parameter_names, orbit.params))
    motion = Witness(d, at["forcing"], d.frequency, float(nodes[first, 0]), nodes[first, 1:])
    for i, mode in zip([i for i in range(d.n) if d.limit[i]], orbit.word.modes[first][len(d.stops) :]):
        motion.slides[i] = mode  # the velocity may be zero to rounding, so its sign is taken from the word
    try:
        motion.run(0.5 * lasts[first] / d.frequency)
        before = motion.y.copy()
        whole = motion.run(motion.time + 2.0 * np.pi * orbit.periods / d.frequency)
    except ValueError as error:
        return f"{orbit.word.text} k={orbit.periods}: {error}"
    if not whole or any(letter[0] == "(" for letter, _ in motion.events):
        return ""  # accumulating impacts, which have a lower accuracy
    off = float(np.abs(motion.y - before).max())
    if off < AGREE * (1.0 + growth):
        return ""
    letters = " ".join(letter for letter, _ in motion.events)
    return f"{orbit.word.text} k={orbit.periods} forcing={at['forcing']:.9g}: off by {off:.2e} (multiplier {growth:.3g}); Newton's laws: {letters}"


def main() -> int:
    """Compare all machines; return 1 if there are findings."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("count", type=int)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--salt", type=int, default=1)
    options = parser.parse_args()
    found = checked = 0
    for seed in range(options.first, options.first + options.count):
        d = draw(options.salt, seed)
        try:
            m = machine(d)
        except ValueError as error:
            print(f"seed {seed}: refused: {error}", flush=True)
            continue
        rng = np.random.default_rng(seed)
        for trial in range(3):
            said = compared(d, m, rng)
            if said:
                found += 1
                print(f"seed {seed}, motion {trial}: {said}", flush=True)
        try:
            orbits = orbits_of(m, rng)
        except ValueError as error:
            found, orbits = found + 1, []
            print(f"seed {seed}: {error}", flush=True)
        for orbit in orbits:
            checked += 1
            said = returning(d, orbit)
            if said:
                found += 1
                print(f"seed {seed}, orbit {said}", flush=True)
    print(f"{options.count} machines, {checked} orbits, {found} findings")
    return min(found, 1)


if __name__ == "__main__":
    warnings.simplefilter("ignore")
    raise SystemExit(main())
