"""Elementary maps of the coupled machine against matrix exponentials in many digits."""

import mpmath as mp
import numpy as np
import pytest

from orbits.arguments import cycle_data, workspace
from orbits.flows.native.reference_kernels import ReferenceKernels
from orbits.machines.parameters import single
from orbits.machines.reference.machine import reference
from tests.orbits.machines.coupled.motion import path

L, R, T, S, U = range(5)
linearise = ReferenceKernels(reference("coupled")).linearise
margins = reference("coupled").margins
# arriving event and the modes: every kind of segment
SEGMENTS = [
    (L, -1, R, 1),
    (R, 1, L, -1),
    (L, -1, T, 1),
    (T, 1, L, -1),
    (S, 0, U, 1),
    (U, 1, S, 0),
    (S, 0, U, -1),
    (U, -1, R, 1),
]
PARAMETERS = [
    [2.47, 0.98, 1.0, 0.006, 0.76, 0.5, 0.211, 1.0, 0.0],
    [1.3, 1.21, 0.7, 0.16, 0.5, 0.35, 0.4, 0.4, 0.2],
    [2.0, 0.8, 0.0, 0.05, 0.9, 0.1, 0.3, 0.0, -0.7],
]


def residual(params, start, mode, arrival, after, x0, x1):
    """The map's four rows: the linear equations of motion, with sin Psi and cos Psi as states, by matrix exponential."""
    G, Omega, lam, eps, r, mu, g, chi, slope = params
    pull, lean = mu * g * mp.cos(slope), g * mp.sin(slope)
    absorber = (mode * pull + lean) if mode else 0
    psi, y, v, v_rate = x0
    w = mp.mpf(1 - 2 * start) if start < 2 else y
    w_rate = v_rate - y if start < 2 else mp.mpf(0)
    force = [-1, -eps * lam, 0, 0, eps * G, eps * G * chi * eps * lam * Omega, 0]
    matrix = mp.zeros(7)
    matrix[0, 1] = matrix[2, 3] = 1
    matrix[4, 5], matrix[5, 4] = Omega, -Omega
    for j in range(7):
        matrix[1, j] = force[j] if mode else force[j] / (1 + eps)
        matrix[3, j] = 0 if mode else force[j] / (1 + eps)
    matrix[1, 6] -= eps * absorber
    matrix[3, 6] += absorber
    state = mp.matrix(
        [
            (v + eps * w) / (1 + eps),
            (v_rate + eps * w_rate) / (1 + eps),
            (v - w) / (1 + eps),
            (v_rate - w_rate) / (1 + eps),
            mp.sin(psi),
            mp.cos(psi),
            1,
        ]
    )
    end = mp.expm(matrix * ((x1[0] - psi) / Omega)) * state
    q1, p1, q2, p2 = end[:4]
    v, v_rate, w, w_rate = q1 + eps * q2, p1 + eps * p2, q1 - q2, p1 - p2
    if arrival < 2:
        rows = [w - (1 - 2 * arrival), v_rate + r * w_rate - x1[1]]
    elif arrival == U:
        rows = [sum(force[j] * end[j] for j in range(7)) - (1 + eps) * (after * pull + lean), w - x1[1]]
    else:
        from_rest = start >= 2 and mode  # then the map is the mean of w'' over the flight
        rows = [w_rate / ((x1[0] - psi) / Omega) if from_rest else w_rate, w - x1[1]]
    return [*rows, v - x1[2], v_rate - x1[3]]


def closed(events, modes, params, path, twist=1.0):
    """Data of a cycle that closes after one period, or after half of one where it is turned round."""
    shift = 2 * np.pi if twist > 0.0 else np.pi
    return cycle_data(events, modes, params, path, twist, shift, 0, 0, params, np.zeros((0, 9)))


@pytest.mark.parametrize("segment", SEGMENTS)
def test_maps_and_all_their_derivatives(segment):
    start, mode, arrival, after = segment
    generator = np.random.default_rng(sum(segment) + 7)
    params = np.array(PARAMETERS[generator.integers(3)])
    u = np.array([0.3, 0.4, 0.2, -0.6, 2.9, -0.5, 0.35, 0.25]) + 0.1 * generator.standard_normal(8)
    work = workspace(2, 4, 9)
    events, modes = np.array([start, arrival], np.int8), np.array([mode, after], np.int8)
    with mp.workdps(40):
        numbers = [mp.mpf(float(value)) for value in (*params, *u)]

        def rows(values):
            return residual(values[:9], start, mode, arrival, after, values[9:13], values[13:])

        def slope(j):
            h = mp.mpf(10) ** -13
            ends = []
            for sign in (1, -1):
                moved = list(numbers)
                moved[j] += sign * h
                ends.append(rows(moved))
            return np.array([float((a - b) / (2 * h)) for a, b in zip(*ends)])

        for ip in range(9):
            assert np.isfinite(linearise(closed(events, modes, params, single(9, ip)), u, params[ip], work))
            F, A, D, Q = (work[i][0] for i in range(4))
            np.testing.assert_allclose(Q, slope(ip), rtol=1e-12, atol=1e-13)
        # a parameter that moves several numbers, each with its own power: the chain rule
        powers = np.array([-1.0, 0.5, -0.5, 2.0, 0.0, 1.0, -2.0, 0.0, 1.0])
        path = np.array([params / 1.3**powers, powers])
        linearise(closed(events, modes, params, path), u, 1.3, work)
        chain = sum(slope(j) * powers[j] * params[j] / 1.3 for j in range(9) if powers[j])
        np.testing.assert_allclose(work[3][0], chain, rtol=1e-11, atol=1e-12)
        linearise(closed(events, modes, params, single(9, 0)), u, params[0], work)
        np.testing.assert_allclose(F, [float(value) for value in rows(numbers)], atol=1e-14)
        for j in range(4):
            np.testing.assert_allclose(A[:, j], slope(9 + j), rtol=1e-12, atol=1e-13)
            np.testing.assert_allclose(D[:, j], slope(13 + j), rtol=1e-12, atol=1e-13)


def inner_minima(values):
    """Values at interior minima, from the parabola through three points."""
    a, b, c = values[:-2], values[1:-1], values[2:]
    here = (b < a) & (b <= c)
    return (b - (c - a) ** 2 / (8.0 * (a - 2.0 * b + c)))[here]


@pytest.mark.parametrize("segment", SEGMENTS)
@pytest.mark.parametrize("case", range(3))
def test_margins_are_those_of_the_motion(segment, case):
    """Against the motion sampled finely: what friction has left, the lowest speed, the walls, the events' own margins."""
    start, mode, arrival, after = segment
    params = np.array(PARAMETERS[case])
    eps, r, mu, g, slope = params[[3, 4, 5, 6, 8]]
    generator = np.random.default_rng(10 * case + sum(segment))
    u = np.array([0.3, 0.4, 0.2, -0.6, 5.9, -0.5, 0.35, 0.25]) + 0.2 * generator.standard_normal(8)
    work = workspace(2, 4, 9)
    events, modes = np.array([start, arrival], np.int8), np.array([mode, after], np.int8)
    data = closed(events, modes, params, single(9, 0))
    linearise(data, u, params[0], work)
    found = np.full(8, np.nan)
    margins(data, u, work, found)
    duration = (u[4] - u[0]) / params[1]
    w, w_rate = (1.0 - 2.0 * start, u[3] - u[1]) if start < 2 else (u[1], 0.0)
    states, q1_2, q2_2 = path(params, mode, u[0], w, w_rate, u[2], u[3], duration, 20000)
    a = (1.0 + eps) * mu * g * np.cos(slope)
    push = q1_2 + eps * q2_2 - (1.0 + eps) * g * np.sin(slope)
    if mode == 0:
        left = a - np.abs(push)
        expected = inner_minima(left)
    else:
        speed = mode * (states[:, 1] - states[:, 3])
        after_start = slice(1, None) if start == S else slice(None)
        expected = inner_minima(speed[after_start])
    if start != T and start != U:
        assert found[0] == pytest.approx(expected.min() if expected.size else np.inf, abs=1e-7)
    assert found[3] == pytest.approx(duration)
    assert found[2] == (pytest.approx(1.0 - abs(u[1])) if start >= 2 else np.inf)
    if start == S:
        assert found[1] == pytest.approx(a - abs(push[0]), abs=1e-12)
    elif start == T:
        assert found[1] == pytest.approx(mode * push[0] - a, abs=1e-12)
    elif start == U:
        h = duration / 20000
        jerk = (-3.0 * q1_2[0] + 4.0 * q1_2[1] - q1_2[2]) / (2.0 * h)
        assert found[1] == pytest.approx(mode * jerk, abs=1e-5)
    if arrival < 2:
        assert found[5] == pytest.approx((1.0 - 2.0 * arrival) * (u[5] - u[7]) / r)
