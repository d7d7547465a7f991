"""Independent computation of orbits and multipliers in many digits, for cases that double precision cannot decide.

Between events every machine has a closed form in each mode; Newton's method solves for the time of the next event. Derivatives of the maps
from event to event are central differences in many digits. Only the word and the start values of nodes come from the package.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import mpmath
import numpy as np
from mpmath import mp, mpf

DIGITS = 80
LEFT, RIGHT, TURN, STICK, SLIP = range(5)


class Shaken:
    """Absorber and cavity: w'' = -C Omega^2 sin Psi - b - s a_s; nodes (Psi, B+ or w)."""

    def __init__(self, given: dict[str, Any]) -> None:
        self.amplitude, self.omega = given["amplitude"], given["frequency"]
        tilt, weight = given.get("slope", mpf(0)), (1 + given["mass_ratio"]) * given["gravity"]
        self.pull, self.wall, self.restitution = {}, {}, {}
        for code, name in ((LEFT, "left"), (RIGHT, "right")):
            side = 1 if code == LEFT else -1
            friction = given.get(f"friction_{name}", given.get("friction"))
            self.pull[side] = -side * weight * friction * mp.cos(tilt) - weight * mp.sin(tilt)
            self.wall[code] = side * given.get(f"distance_{name}", mpf(1))
            self.restitution[code] = given.get(f"restitution_{name}", given.get("restitution"))

    def state(self, code: int, node: list[Any]) -> list[Any]:
        """(Psi, w, w') after an event."""
        if code in self.wall:
            return [
                node[0],
                self.wall[code],
                self.amplitude * self.omega * mp.cos(node[0]) - node[1],
            ]
        return [node[0], node[1], mpf(0)]

    def flow(self, mode: int, state: list[Any], time: Any) -> list[Any]:
        """The state some time later."""
        first, w, rate = state
        psi = first + self.omega * time
        if mode == 0:
            return [psi, w, rate]
        speed = self.amplitude * self.omega
        pulled = self.pull[mode] * time
        w += (
            self.amplitude * (mp.sin(psi) - mp.sin(first))
            + (rate - speed * mp.cos(first) + pulled / 2) * time
        )
        return [psi, w, rate + speed * (mp.cos(psi) - mp.cos(first)) + pulled]

    def event(self, code: int, after: int, state: list[Any]) -> Any:
        """Return the function that vanishes at an event; at a slip, friction acts in the direction of the following sliding (mode `after`)."""
        if code in self.wall:
            return state[1] - self.wall[code]
        if code == SLIP:
            return self.pull[after] - self.amplitude * self.omega**2 * mp.sin(state[0])
        return state[2]

    def node(self, code: int, state: list[Any]) -> list[Any]:
        """The node of an event from the state in which it finds the machine."""
        psi, w, rate = state
        if code in self.wall:
            return [psi, self.amplitude * self.omega * mp.cos(psi) + self.restitution[code] * rate]
        return [psi, w]


class Damped:
    """The coupled machine: q1'' + c q1' + q1 = e + x c e' / eps - eps mu g S, q2'' = mu g S; nodes (Psi, B+ or w, v, v')."""

    def __init__(self, given: dict[str, Any]) -> None:
        self.eps, self.omega, self.restitution = (
            given[name] for name in ("mass_ratio", "frequency", "restitution")
        )
        self.friction, self.drag = given["friction"] * given["gravity"], self.eps * given["damping"]
        base = self.eps * given["forcing"]
        self.shaking = base * (1 + 1j * given["excitation"] * self.drag * self.omega)
        self.wall = {LEFT: mpf(1), RIGHT: mpf(-1)}

    def state(self, code: int, node: list[Any]) -> list[Any]:
        """(Psi, q1, q1', q2, q2') after an event."""
        psi, second, v, rate = node
        w, w_rate = (self.wall[code], rate - second) if code in self.wall else (second, mpf(0))
        q2, q2_rate = (v - w) / (1 + self.eps), (rate - w_rate) / (1 + self.eps)
        return [psi, q2 + w, q2_rate + w_rate, q2, q2_rate]

    def flow(self, mode: int, state: list[Any], time: Any) -> list[Any]:
        """The state some time later."""
        first, q1, q1_rate, q2, q2_rate = state
        psi, turn = first + self.omega * time, 1j * self.omega
        mass = 1 + self.eps if mode == 0 else mpf(1)  # while sticking, both masses move as one
        answer = self.shaking / (1 + self.drag * turn + mass * turn**2)
        constant = -self.eps * self.friction * mode

        def forced(phase: Any) -> tuple[Any, Any]:
            wave = answer * mp.expj(phase)
            return mp.im(wave) + constant, mp.im(turn * wave)

        (before, before_rate), (after, after_rate) = forced(first), forced(psi)
        root = mp.sqrt(mpmath.mpc(self.drag**2 - 4 * mass))
        fast, slow = (-self.drag + root) / (2 * mass), (-self.drag - root) / (2 * mass)
        gap, gap_rate = q1 - before, q1_rate - before_rate
        part = (gap_rate - slow * gap) / (fast - slow)
        one, other = part * mp.exp(fast * time), (gap - part) * mp.exp(slow * time)
        new, new_rate = mp.re(one + other) + after, mp.re(fast * one + slow * other) + after_rate
        if mode == 0:
            return [psi, new, new_rate, q2 + new - q1, new_rate]
        pulled = mode * self.friction * time
        return [psi, new, new_rate, q2 + (q2_rate + pulled / 2) * time, q2_rate + pulled]

    def event(self, code: int, after: int, state: list[Any]) -> Any:
        """Return the function that vanishes at an event; at a slip, the force needed for the common acceleration equals the largest friction."""
        psi, q1, q1_rate, q2, q2_rate = state
        if code in self.wall:
            return q1 - q2 - self.wall[code]
        if code == SLIP:
            pushed = mp.im(self.shaking * mp.expj(psi)) - self.drag * q1_rate - q1
            return pushed / (1 + self.eps) - after * self.friction
        return q1_rate - q2_rate

    def node(self, code: int, state: list[Any]) -> list[Any]:
        """The node of an event from the state in which it finds the machine."""
        psi, q1, q1_rate, q2, q2_rate = state
        v, rate = q1 + self.eps * q2, q1_rate + self.eps * q2_rate
        second = rate + self.restitution * (q1_rate - q2_rate) if code in self.wall else q1 - q2
        return [psi, second, v, rate]


class Exact(NamedTuple):
    """An orbit in many digits: differences of parameter and nodes from the given ones, multipliers, dnode/dparameter,
    nodes and parameter.
    """

    shift: float
    moved: float
    multipliers: np.ndarray
    steepness: float
    nodes: list[list[Any]]
    value: Any


class Motion:
    """The events of an orbit, in many digits."""

    def __init__(self, orbit: Any) -> None:
        self.given = {k: v if isinstance(v, str) else mpf(float(v)) for k, v in orbit.parameters.items()}
        self.codes = [int(code) for code in orbit.word.codes]
        self.modes = [int(mode) for mode in orbit.word.mode_codes]
        self.parameter, self.periods = orbit.model.default_parameter, orbit.periods
        self.kind = Damped if "damping" in self.given else Shaken

    def machine(self, value: Any) -> Any:
        """Return the machine at a value of the parameter."""
        return self.kind({**self.given, self.parameter: value})

    def step(self, machine: Any, i: int, node: list[Any], time: Any) -> tuple[Any, list[Any]]:
        """Return the event function of the event after event i and the rest of its node, if it happens `time` later."""
        j = (i + 1) % len(self.codes)
        state = machine.flow(self.modes[i], machine.state(self.codes[i], node), time)
        return machine.event(self.codes[j], self.modes[j], state), machine.node(self.codes[j], state)[1:]


def exact(orbit: Any) -> Exact | None:
    """Solve for the orbit next to a given one, with the parameter as an unknown; the correction is orthogonal to the branch.

    At a fixed value of the parameter the orbit may be ill-conditioned, or not exist in windows that are narrower than rounding.
    Return None for motions without impacts, whose position is free, and if Newton's method does not converge.
    """
    if not orbit.impacts:
        return None
    with mp.workdps(DIGITS):
        try:
            motion = Motion(orbit)
            return solved(motion, orbit.nodes, motion.given[motion.parameter])
        except (ArithmeticError, ValueError):
            return None


def rounds_apart(orbit: Any, periods: int) -> float:
    """Largest phase difference between the impacts of an orbit and those `periods` forcing periods later, in many digits.

    Zero to rounding (of 80 digits) if the orbit repeats a shorter one; inf if the walls differ; nan if the orbit is not solved.
    """
    found = exact(orbit)
    if found is None:
        return float("nan")
    codes = [int(code) for code in orbit.word.codes]
    places = [i for i, code in enumerate(codes) if code in (LEFT, RIGHT)]
    count = len(places)
    later, left = divmod(count * periods, orbit.periods)
    if left or any(codes[places[j]] != codes[places[(j + later) % count]] for j in range(count)):
        return float("inf")
    with mp.workdps(DIGITS):
        phases = [found.nodes[i][0] for i in places]
        phases += [phase + 2 * mp.pi * orbit.periods for phase in phases]
        return float(max(abs(phases[j + later] - phases[j] - 2 * mp.pi * periods) for j in range(count)))


def solved(motion: Motion, claimed: Any, value: Any, sweeps: int = 12) -> Exact | None:
    """Solve for the orbit next to given nodes and parameter, both of which may have many digits; None without convergence."""
    start = [[mpf(x) for x in row] for row in claimed]
    size, first = len(start[0]), value
    nodes = [list(row) for row in start]
    for _ in range(sweeps):
        maps, pushes, gaps = _linearised(motion, nodes, value)
        product, along, left = mp.eye(size), mp.matrix(size, 1), mp.matrix(size, 1)
        for A, q, r in zip(maps, pushes, gaps):
            product, along, left = A * product, A * along + q, A * left + r
        # (1 - product) d - along dp = left: one equation short of square
        system = mp.matrix(size, size + 1)
        for i in range(size):
            for j in range(size):
                system[i, j] = (i == j) - product[i, j]
            system[i, size] = -along[i]
        null = _null(system)
        whole = mp.matrix(size + 1, size + 1)
        for i in range(size + 1):
            for j in range(size + 1):
                whole[i, j] = system[i, j] if i < size else null[j]
        found = mp.lu_solve(whole, mp.matrix([*left, 0]))
        step, tangent = (
            _carried(vector, maps, pushes, gaps if vector is found else None) for vector in (found, null)
        )
        off = [x + d - x0 for row, ds, row0 in zip(nodes, step[0], start) for x, d, x0 in zip(row, ds, row0)]
        flat = [t for row in tangent[0] for t in row]
        square = sum(t * t for t in flat) + tangent[1] ** 2
        back = (sum(t * x for t, x in zip(flat, off)) + tangent[1] * (value + step[1] - first)) / square
        nodes = [
            [x + d - back * t for x, d, t in zip(row, ds, ts)]
            for row, ds, ts in zip(nodes, step[0], tangent[0])
        ]
        value += step[1] - back * tangent[1]
        worst = max(abs(x) for gap in gaps for x in gap)
        if worst < mpf(10) ** (-DIGITS // 2):
            spectrum = mp.eig(product, left=False, right=False)
            moved = max(abs(x - x0) for row, row0 in zip(nodes, start) for x, x0 in zip(row, row0))
            steep = max(abs(t) for t in flat) / abs(tangent[1]) if tangent[1] else mp.inf
            return Exact(
                float(value - first),
                float(moved),
                np.array([complex(z) for z in spectrum]),
                float(steep),
                nodes,
                value,
            )
    return None


def _linearised(motion: Motion, nodes: list[Any], value: Any) -> tuple[list[Any], list[Any], list[Any]]:
    """Return derivatives of the maps from event to event, their derivatives by the parameter, and their residuals.

    The time between events is that of the nodes, corrected by one Newton step. So an impact of small speed, which inaccurate
    nodes would miss, need not be located before the nodes are accurate.
    """
    small, size = mpf(10) ** (-mp.dps // 3), len(nodes[0])
    here, above, below = (motion.machine(value + part * small) for part in (0, 1, -1))
    maps, pushes, gaps = [], [], []

    def difference(ends: list[tuple[Any, list[Any]]]) -> tuple[Any, list[Any]]:
        (late, after), (early, before) = ends
        return (late - early) / (2 * small), [(a - b) / (2 * small) for a, b in zip(after, before)]

    for i, node in enumerate(nodes):
        wanted = list(nodes[(i + 1) % len(nodes)])
        if i == len(nodes) - 1:
            wanted[0] += 2 * mp.pi * motion.periods
        time = (wanted[0] - node[0]) / here.omega
        missed, rest = motion.step(here, i, node, time)
        flow = difference([motion.step(here, i, node, time + part * small) for part in (1, -1)])
        late, *others = _at_event((missed, [a - b for a, b in zip(rest, wanted[1:])]), flow)
        gaps.append(mp.matrix([here.omega * late, *others]))
        # the phase of an event depends on that of the one before, on the time between them and on the phase rate
        late, *others = _at_event(difference([motion.step(m, i, node, time) for m in (above, below)]), flow)
        rate = (above.omega - below.omega) / (2 * small)
        pushes.append(mp.matrix([here.omega * late + rate * time, *others]))
        A = mp.matrix(size, size)
        for k in range(size):
            ends = [[x + part * small * (j == k) for j, x in enumerate(node)] for part in (1, -1)]
            late, *others = _at_event(difference([motion.step(here, i, end, time) for end in ends]), flow)
            for j, change in enumerate([here.omega * late + (k == 0), *others]):
                A[j, k] = change
        maps.append(A)
    return maps, pushes, gaps


def _at_event(changes: tuple[Any, list[Any]], flow: tuple[Any, list[Any]]) -> list[Any]:
    """Return the change of the event's time, and the changes of the rest of its node at the event.

    They follow from `changes` of the event function and of the node at a fixed time, and from their time derivatives (`flow`).
    """
    later = -changes[0] / flow[0]
    return [later, *(change + later * rate for change, rate in zip(changes[1], flow[1]))]


def _null(system: Any) -> list[Any]:
    """Null vector of a matrix with one more column than rows, by its minors."""
    size = system.rows
    vector = []
    for left_out in range(size + 1):
        minor = mp.matrix(size, size)
        for i in range(size):
            for k, j in enumerate(j for j in range(size + 1) if j != left_out):
                minor[i, k] = system[i, j]
        vector.append((-1) ** left_out * mp.det(minor))
    largest = max(abs(x) for x in vector)
    return [x / largest for x in vector]


def _carried(
    vector: Any, maps: list[Any], pushes: list[Any], gaps: list[Any] | None
) -> tuple[list[Any], Any]:
    """Map a change of the first node and of the parameter to all nodes."""
    size = maps[0].rows
    change, rows = mp.matrix(list(vector)[:size]), []
    for i, (A, q) in enumerate(zip(maps, pushes)):
        rows.append(list(change))
        change = A * change + q * vector[size]
        if gaps is not None:
            change += gaps[i]
    return rows, vector[size]
