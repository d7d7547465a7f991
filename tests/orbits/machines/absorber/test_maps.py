"""The elementary maps against finite differences, the paper's tables and a dense solver."""

import mpmath as mp
import numpy as np
import pytest

from orbits import Absorber
from orbits.machines.reference.machine import reference
from orbits.problem import OrbitProblem
from orbits.words import Word

MACHINE = Absorber(restitution=0.7, friction=0.4, gravity=0.3, mass_ratio=0.02, frequency=1.2)
CASES = [("LR", 1, False), ("LR", 1, True), ("RLtL", 1, False), ("LRts", 1, False), ("tt", 1, True), ("tt", 1, False),
         ("ss", 1, True), ("ss", 1, False), ("LRtt", 2, False), ("LsRs", 1, True), ("sttstt", 1, True), ("Lt", 1, False)]  # fmt: skip


def some_nodes(problem, seed):
    generator = np.random.default_rng(seed)
    u = generator.normal(size=problem.dimension)
    u[::2] = np.sort(generator.uniform(0.0, 2.0 * np.pi, problem.length))
    return u


def residual(problem, u, p):
    work = problem.workspace()
    reference("absorber").linearise(problem.data, u, p, work)
    return work[0].ravel().copy()


def dense(problem, u, p):
    """F, and the matrix [dF/du, dF/dp] put together from the blocks."""
    work = problem.workspace()
    reference("absorber").linearise(problem.data, u, p, work)
    F, A, D, Q = work[:4]
    n, N = 2, problem.dimension
    J = np.zeros((N, N + 1))
    for i in range(problem.length):
        rows = slice(n * i, n * i + n)
        j = (i + 1) % problem.length
        closing = np.array([1.0, problem.twist]) if i == problem.length - 1 else 1.0
        J[rows, n * i : n * i + n] += A[i]
        J[rows, n * j : n * j + n] += D[i] * closing
        J[rows, N] = Q[i]
    return F.ravel().copy(), J, work


@pytest.mark.parametrize(("text", "periods", "symmetric"), CASES)
@pytest.mark.parametrize("parameter", MACHINE.parameter_names)
def test_derivatives_are_those_of_finite_differences(text, periods, symmetric, parameter):
    params = MACHINE.vector({"amplitude": 0.6})
    problem = OrbitProblem(MACHINE, Word.parse(text), periods, parameter, params, symmetric)
    u, p, h = some_nodes(problem, 3), problem.value(params), 1e-5
    _, J, _ = dense(problem, u, p)
    for j in range(problem.dimension + 1):

        def moved(step, j=j):
            v = u.copy()
            if j < v.size:
                v[j] += step
                return residual(problem, v, p)
            return residual(problem, v, p + step)

        # fourth-order central difference
        slope = (8.0 * (moved(h) - moved(-h)) - (moved(2 * h) - moved(-2 * h))) / (12.0 * h)
        np.testing.assert_allclose(J[:, j], slope, atol=2e-9 * max(1.0, np.abs(slope).max()))


def test_alternating_impacts_are_the_published_maps():
    """G+_LR and G+_RL as printed by Youssef, Karoui, Leine (their table of elementary mappings)."""
    params = MACHINE.vector({"amplitude": 0.6})
    C, r, mu, g, eps, omega = params
    problem = OrbitProblem(MACHINE, Word.parse("LR"), 1, "amplitude", params)
    u = np.array([0.3, 1.1, 3.0, -0.9])
    end = u[:2] + [2.0 * np.pi, 0.0]
    pull = mu * g * (1.0 + eps)

    def G(a, b, s):
        return [
            b[1] + r * a[1] - (1 + r) * C * omega * np.cos(b[0]) - s * r * pull / omega * (b[0] - a[0]),
            -a[1] / omega * (b[0] - a[0])
            + C * (np.sin(b[0]) - np.sin(a[0]))
            + s * 0.5 * pull / omega**2 * (b[0] - a[0]) ** 2
            + 2.0 * s,
        ]

    length, rate = problem.equations.units  # unknowns and equations are in units of the machine's own size
    found = residual(problem, problem.reduce(u.reshape(-1, 2)), C) * [rate, length, rate, length]
    np.testing.assert_allclose(found, [*G(u[:2], u[2:], 1.0), *G(u[2:], end, -1.0)], atol=1e-14)


@pytest.mark.parametrize("lasting", [1e-7, 1e-4, 1.9e-3, 2.1e-3, 0.05])
def test_short_flights_from_rest_to_rest_keep_their_digits(lasting):
    """The map is the mean of w'' over the flight; against fifty digits, with its derivatives."""
    word = Word.parse("tt")
    problem = OrbitProblem(MACHINE, word, 1, "amplitude", MACHINE.vector({"amplitude": 0.8}))
    work = problem.workspace()
    start = 0.9
    end = start + lasting
    reference("absorber").linearise(problem.data, np.array([start, 0.1, end, 0.1]), 0.8, work)
    with mp.workdps(50):
        a, Omega, mode = mp.mpf(0.4) * mp.mpf(0.3) * (1 + mp.mpf(0.02)), mp.mpf(1.2), word.modes[0]

        def mean(C, psi0, psi1):
            return C * Omega**2 * (mp.cos(psi1) - mp.cos(psi0)) / (psi1 - psi0) - mode * a

        at = mp.mpf(0.8), mp.mpf(start), mp.mpf(end)
        length, rate = problem.equations.units
        acceleration = rate**2 / length
        assert acceleration * work[0][0, 0] == pytest.approx(float(mean(*at)), rel=1e-12)
        slopes = [float(mp.diff(mean, at, order)) for order in ((1, 0, 0), (0, 1, 0), (0, 0, 1))]
    found = [acceleration * slope for slope in (work[3][0, 0], work[1][0, 0, 0], work[2][0, 0, 0])]
    assert found == pytest.approx(slopes, rel=1e-9)
