"""With and without the optimisations: the same special points to 1e-10.

The same equations once with the compiled loop (elimination in chains and lanes, scaled products, compiled scan), once with the
interpreted loop and plain numpy: a dense Jacobian, `numpy.linalg.solve`, eigenvalues of the product of the factors.
"""

import numpy as np
import pytest

import contvines as cv
from contvines.problems.dense import KERNELS, dense_workspace
from contvines.problems.protocol import Kernels
from orbits import Absorber, Coupled
from orbits.problem import OrbitProblem

ABSORBER = Absorber(restitution=0.76, friction=0.5, gravity=0.211, mass_ratio=0.006)


class Plain(OrbitProblem):
    """An orbit problem whose algebra is numpy's."""

    def __init__(self, problem, u, p):
        super().__init__(
            problem.model, problem.word, problem.periods, problem.parameter, problem.params, problem.symmetric
        )
        self.u0, self.p0, self.inner = u, p, self.data
        self.data = Data(self)

    @property
    def kernels(self):
        return Kernels(KERNELS.linearise, KERNELS.bordered, inspect, compiled=False)

    def workspace(self):
        return dense_workspace(self.dimension)

    def linearised(self, u, p):
        work = super().workspace()
        self.model_kernels.linearise(self.inner, np.array(u), float(p), work)
        return work

    @property
    def model_kernels(self):
        return super().kernels

    def plain_equations(self, u, p):
        F, A, D, Q = self.linearised(u, p)[:4]
        length, n = F.shape
        jacobian = np.zeros((length * n, length * n))
        closure = np.diag(np.r_[1.0, np.full(n - 1, self.twist)])
        for i in range(length):
            rows, after = slice(i * n, i * n + n), (i + 1) % length
            jacobian[rows, rows] += A[i]
            jacobian[rows, after * n : after * n + n] += D[i] @ (closure if i + 1 == length else np.eye(n))
        return F.ravel(), jacobian, Q.ravel()


class Data:
    """What the plain kernels are handed: the problem, under the name by which they ask for its equations."""

    def __init__(self, problem):
        self.problem, self.equations = problem, problem.plain_equations

    def __getattr__(self, name):
        return getattr(self.problem, name)


def inspect(problem, u, p, work, row):
    """Multipliers by numpy; the margins are the model's."""
    work = problem.linearised(u, p)
    n = problem.model.node
    product = np.eye(n)
    for A, D in zip(work[1], work[2]):
        try:
            product = -np.linalg.solve(D, A) @ product
        except np.linalg.LinAlgError:  # at an impact without speed
            product = np.full((n, n), np.nan)
            break
    closed = np.diag(np.r_[1.0, np.full(n - 1, problem.twist)]) @ product
    spectrum = (
        np.linalg.eigvals(closed).astype(complex) if np.isfinite(closed).all() else np.full(n, np.nan + 0j)
    )
    spectrum = spectrum[np.argsort(-np.abs(spectrum), kind="stable")]
    problem.model_kernels.inspect(problem.inner, np.array(u), float(p), work, row)
    row[0 : 2 * n : 2], row[1 : 2 * n : 2] = np.real(spectrum), np.imag(spectrum)


def found(problem, within, **settings):
    problem.beyond = lambda point: []  # this problem's solutions only, the virtual ones included
    graph = cv.diagram(problem, within=within, depth=0, virtual=True, settings=settings)
    return sorted((point.kind, point.value) for point in graph.special.values() if point.kind != "end")


def both(problem, u, p, within, **settings):
    problem.u0, problem.p0 = u, p
    fast, plain = found(problem, within, **settings), found(Plain(problem, u, p), within, **settings)
    assert [kind for kind, _ in fast] == [kind for kind, _ in plain]
    np.testing.assert_allclose([v for _, v in fast], [v for _, v in plain], rtol=0.0, atol=1e-10)
    return {kind for kind, _ in fast}


@pytest.mark.parametrize("times", [1, 2, 8, 17])
def test_the_symmetric_orbit_written_many_times(times):
    """Up to 34 nodes: in one chain, in two, in lanes with two nodes left over."""
    orbit = ABSORBER.symmetric_orbit(0.55).repeat(times)
    problem = orbit.problem("amplitude", symmetric=False)
    kinds = both(problem, *orbit.seed(problem), within=(0.2, 0.9), max_step=0.02)
    assert {"fold", "symmetry-breaking"} <= kinds | (
        {"symmetry-breaking"} if "branch-point" in kinds else set()
    )


def test_a_word_with_turns():
    orbit = ABSORBER.orbit("LRtt", 1, amplitude=0.95)
    problem = orbit.problem("amplitude")
    assert both(problem, *orbit.seed(problem), within=(0.7, 1.3)) >= {"period-doubling", "fold"}


def test_the_coupled_machine():
    machine = Coupled(
        restitution=0.76,
        friction=0.5,
        gravity=0.211,
        mass_ratio=0.006,
        damping=1.0,
        forcing=2.47,
        frequency=1.0,
    )
    orbit = machine.orbit("LR", 1)
    problem = orbit.problem("frequency")
    assert both(problem, *orbit.seed(problem), within=(0.96, 1.04), max_step=0.02) & {
        "fold",
        "neimark-sacker",
    }
