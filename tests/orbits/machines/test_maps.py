"""Elementary maps of all machines, their derivatives, margins and samples, against matrix exponentials of the equations of motion in many digits."""

from itertools import cycle

import mpmath as mp
import numpy as np
import pytest
from scipy.linalg import expm

from orbits.arguments import cycle_data, workspace
from orbits.flows.native.cycle_equations import assemble
from orbits.flows.native.reference_kernels import ReferenceKernels
from orbits.machines.names import usual
from orbits.machines.parameters import single
from orbits.machines.reference.machine import reference

L, R, T, S, U = range(5)
# arriving event and the modes: every kind of segment
SEGMENTS = [
    (L, -1, R, 1), (R, 1, L, -1), (L, -1, T, 1), (T, 1, L, -1), (S, 0, U, 1), (U, 1, S, 0), (S, 0, U, -1), (U, -1, R, 1),
]  # fmt: skip
NUMBERS = {
    "absorber": [[0.6, 0.7, 0.4, 0.3, 0.02, 1.2]],
    "cavity": [[0.31, 0.7, 0.6, 0.3, 0.8, 0.5, 0.2, 1.3, 0.4, 1.2, 0.7]],
    "coupled": [
        [2.47, 0.98, 1.0, 0.006, 0.76, 0.5, 0.211, 1.0, 0.0],
        [1.3, 1.21, 0.7, 0.16, 0.5, 0.35, 0.4, 0.4, 0.2],
        [2.0, 0.8, 0.0, 0.05, 0.9, 0.1, 0.3, 0.0, -0.7],
    ],
}
CASES = [
    (name, numbers, segment)
    for name, given in NUMBERS.items()
    for numbers, segment in zip(cycle(given), [*SEGMENTS, (T, 1, S, 0)])
]
REST = [case for case in CASES if case[2][0] >= T and case[2][1] and case[2][2] in (T, S)]
SHORT = [0.05, 1.9e-3, 1e-7, 1e-13, 0.0, -1e-12]


class Motion:
    """Newton's law for q1, the cavity, and q2, the absorber; sin Psi, cos Psi and 1 are states as well. A shaken cavity does not feel its absorber."""

    def __init__(self, name, params):
        self.shaken = name != "coupled"
        if self.shaken:
            if name == "absorber":
                C, r, mu, g, eps, Omega = params
                params = [C, r, r, mu, mu, g, eps, Omega, 0, 1, 1]
            C, r_left, r_right, mu_left, mu_right, g, eps, Omega, slope, left, right = params
            self.force, weight, self.eps = [0, 0, 0, 0, -C * Omega**2, 0, 0], (1 + eps) * g, 0
        else:
            G, Omega, lam, eps, r_left, mu_left, weight, chi, slope = params
            r_right, mu_right, left, right = r_left, mu_left, 1, 1
            self.force, self.eps = [-1, -eps * lam, 0, 0, eps * G, eps * G * chi * eps * lam * Omega, 0], eps
        self.Omega, self.C = Omega, params[0]
        self.lean = weight * mp.sin(slope)
        self.friction = {1: mu_left * weight * mp.cos(slope), -1: mu_right * weight * mp.cos(slope)}
        self.walls, self.restitutions = (left, -right), (r_left, r_right)

    def pull(self, mode):
        """q2'' while it slides."""
        return mode * self.friction[mode] + self.lean

    def matrix(self, mode):
        heavy = 1 if mode else 1 + self.eps
        rows = [[0] * 7 for _ in range(7)]
        rows[0][1] = rows[2][3] = 1
        rows[4][5], rows[5][4] = self.Omega, -self.Omega
        rows[1] = [entry / mp.mpf(heavy) for entry in self.force]
        rows[3] = [0] * 6 + [self.pull(mode)] if mode else rows[1]
        if mode:
            rows[1][6] -= self.eps * self.pull(mode)
        return rows

    def begin(self, event, node):
        """States at a node, and w, w', v, v'."""
        psi, y, *cavity = node
        v, v_rate = cavity or (self.C * mp.sin(psi), self.C * self.Omega * mp.cos(psi))
        w, rate = (self.walls[event], v_rate - y) if event < 2 else (y, 0)
        whole = 1 + self.eps
        bodies = [
            (v + self.eps * w) / whole,
            (v_rate + self.eps * rate) / whole,
            (v - w) / whole,
            (v_rate - rate) / whole,
        ]
        return [*bodies, mp.sin(psi), mp.cos(psi), 1], (w, rate, v, v_rate)

    def seen(self, states):
        """w, w', v, v' of states."""
        q1, p1, q2, p2 = states[:4]
        return q1 - q2, p1 - p2, q1 + self.eps * q2, p1 + self.eps * p2

    def rows(self, segment, x0, x1):
        """What the map of a segment has for its equations."""
        start, mode, arrival, after = segment
        t = (x1[0] - x0[0]) / self.Omega + mp.mpf(10) ** -30
        end = mp.expm(mp.matrix(self.matrix(mode)) * t) * mp.matrix(self.begin(start, x0)[0])
        w, rate, v, v_rate = self.seen(end)
        if arrival < 2:
            rows = [w - self.walls[arrival], v_rate + self.restitutions[arrival] * rate - x1[1]]
            rows = [-rows[1], rows[0]] if self.shaken else rows
        elif arrival == U:
            slips = sum(f * y for f, y in zip(self.force, end)) - (1 + self.eps) * self.pull(after)
            rows = [-slips if self.shaken else slips, w - x1[1]]
        else:  # from rest to rest it is the mean of w'' over the flight
            rows = [rate / t if start >= 2 and mode else rate, w - x1[1]]
        return rows if self.shaken else [*rows, v - x1[2], v_rate - x1[3]]


def closed(name, params, segment, path):
    """Data and workspace of a cycle of two events whose first segment is the one asked for."""
    start, mode, arrival, after = segment
    none = np.zeros((0, len(params)))
    data = cycle_data([start, arrival], [mode, after], params, path, 1.0, 2 * np.pi, 0, 0, params, none)
    return data, workspace(2, 4 if name == "coupled" else 2, len(params))


def nodes_of(name, segment, last, spread):
    nodes = np.array([[0.3, 0.4, 0.2, -0.6], [last, -0.5, 0.35, 0.25]])
    nodes += spread * np.random.default_rng(sum(segment) + 7).standard_normal((2, 4))
    return nodes if name == "coupled" else nodes[:, :2]


def agree(name, params, segment, u):
    """Rows, and their derivatives by all parameters and unknowns, in both cores."""
    params, count, n = np.array(params), len(params), u.shape[1]
    with mp.workdps(80):
        numbers = [mp.mpf(float(value)) for value in (*params, *u.ravel())]

        def rows(step=0, j=0):
            moved = [*numbers[:j], numbers[j] + step, *numbers[j + 1 :]]
            return np.array(Motion(name, moved[:count]).rows(segment, moved[count:-n], moved[-n:]))

        step, value = mp.mpf(10) ** -25, rows()
        slopes = np.array([(rows(step, j) - value) / step for j in range(len(numbers))]).T.astype(float)
    powers = np.resize([-1.0, 0.5, -0.5, 2.0, 0.0, 1.0, -2.0, 0.0, 1.0], count)
    varied = [(single(count, j), params[j], slopes[:, j]) for j in range(count)]
    # a parameter that moves several numbers, each with its own power: the chain rule
    varied.append(
        (np.array([params / 1.3**powers, powers]), 1.3, slopes[:, :count] @ (powers * params / 1.3))
    )
    for kernels in (ReferenceKernels(reference(name)), assemble(usual(name)[0])):
        for path, p, along in varied:
            data, work = closed(name, params, segment, path)
            assert np.isfinite(kernels.linearise(data, u.ravel(), p, work))
            np.testing.assert_allclose(work.F[0], value.astype(float), rtol=1e-12, atol=1e-14)
            expected = np.column_stack([along, slopes[:, count:]])
            found = np.column_stack([work.Q[0], work.A[0], work.D[0]])
            np.testing.assert_allclose(found, expected, rtol=1e-9, atol=1e-12)


@pytest.mark.slow
@pytest.mark.parametrize(("name", "params", "segment"), CASES)
def test_maps_and_all_their_derivatives(name, params, segment):
    agree(name, params, segment, nodes_of(name, segment, 2.9, 0.1))


@pytest.mark.parametrize("lasting", SHORT)
@pytest.mark.parametrize(("name", "params", "segment"), REST)
def test_flights_from_rest_to_rest_however_short(name, params, segment, lasting):
    """Where a turn and a stick fall together the flight between them has no duration."""
    u = nodes_of(name, segment, 2.9, 0.1)
    u[1, 0] = u[0, 0] + lasting
    agree(name, params, segment, u)


def inner_minima(values):
    """Values at interior minima, from the parabola through three points."""
    a, b, c = values[:-2], values[1:-1], values[2:]
    here = (b < a) & (b <= c)
    return (b - (c - a) ** 2 / (8.0 * (a - 2.0 * b + c)))[here]


@pytest.mark.parametrize(("name", "params", "segment"), CASES)
def test_margins_and_samples_are_those_of_the_motion(name, params, segment):
    """The motion sampled finely: what friction has left, the lowest speed, the walls, the events' own margins."""
    start, mode, arrival, after = segment
    motion, params, u = Motion(name, params), np.array(params), nodes_of(name, segment, 5.9, 0.2)
    data, work = closed(name, params, segment, single(len(params), 0))
    reference(name).linearise(data, u.ravel(), params[0], work)
    found = np.full(8, np.nan)
    reference(name).margins(data, u.ravel(), work, found)
    omega = float(motion.Omega)
    states, seen = motion.begin(start, u[0])
    duration, count = (u[1, 0] - u[0, 0]) / omega, 20000
    step, path = expm(np.array(motion.matrix(mode), float) * duration / count), [np.array(states, float)]
    for _ in range(count):
        path.append(step @ path[-1])
    w, rate, v, v_rate = motion.seen(np.array(path).T)
    begin = np.array([u[0, 0], *map(float, seen[:2]), mode, 0.0, 0.0, *map(float, seen[2:])])
    places, samples = np.array([7, 3000, count]), np.empty((3, 4))
    reference(name).sample(np.tile(begin, (3, 1)), params, omega * duration * places / count, samples)
    np.testing.assert_allclose(samples.T, np.array([w, rate, v, v_rate])[:, places], atol=1e-11)
    push = np.array(path) @ np.array(motion.force, float) - (1.0 + float(motion.eps)) * float(motion.lean)
    a = {s: float((1.0 + motion.eps) * friction) for s, friction in motion.friction.items()}
    if mode and start in (L, R, S):
        lowest = inner_minima((mode * rate)[start == S :])
        assert found[0] == pytest.approx(lowest.min(initial=np.inf), abs=1e-7)
    elif not mode and not motion.shaken:
        assert found[0] == pytest.approx(inner_minima(a[1] - np.abs(push)).min(initial=np.inf), abs=1e-7)
    left, right = motion.walls
    assert found[2] == (pytest.approx(min(left - u[0, 1], u[0, 1] - right)) if start >= T else np.inf)
    assert found[3] == pytest.approx(duration)
    if start == S:
        assert found[1] == pytest.approx(min(a[1] - push[0], a[-1] + push[0]), abs=1e-12)
    elif start == T and after:  # the mode before it
        assert found[1] == pytest.approx(mode * push[0] - a[mode], abs=1e-12)
    elif start == U:
        jerk = (-3.0 * push[0] + 4.0 * push[1] - push[2]) * count / (2.0 * duration)
        assert found[1] == pytest.approx(mode * jerk / (omega if motion.shaken else 1.0), abs=1e-5)
    if arrival in (L, R):
        back = motion.seen(motion.begin(arrival, u[1])[0])[1] / motion.restitutions[arrival]
        closing = rate[-1] if motion.shaken else -float(back)
        assert found[5] == pytest.approx((1.0, -1.0)[arrival] * closing)
