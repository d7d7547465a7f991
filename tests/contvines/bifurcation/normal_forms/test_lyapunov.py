"""Sign of the first Lyapunov coefficient of drawn maps, decided by iterating them; criticality in a diagram."""

import numpy as np
import pytest

import contvines as cv
from contvines.bifurcation.normal_forms.coefficients import Forms

COUNT, STEPS, RADIUS = 100, 6000, 0.004


@pytest.mark.slow
def test_sign_of_100_drawn_maps_is_that_of_their_simulation():
    rng = np.random.default_rng(11)
    # angles away from the strong resonances
    low, high = rng.uniform(0.25, 1.45, COUNT), rng.uniform(2.2, 3.0, COUNT)
    theta = np.where(rng.random(COUNT) < 0.6, low, high)
    rotation = np.array([[np.cos(theta), -np.sin(theta)], [np.sin(theta), np.cos(theta)]]).transpose(2, 0, 1)
    change = 0.25 * rng.standard_normal((COUNT, 2, 2)) + np.eye(2)
    linear = change @ rotation @ np.linalg.inv(change)
    quadratic = rng.uniform(-1, 1, (COUNT, 2, 2, 2))
    cubic = rng.uniform(-1, 1, (COUNT, 2, 2, 2, 2))

    def step(x):
        return (
            np.einsum("kij,kj->ki", linear, x)
            + np.einsum("kijl,kj,kl->ki", quadratic, x, x)
            + np.einsum("kijlm,kj,kl,km->ki", cubic, x, x, x)
        )

    back = np.linalg.inv(change)

    def size(x):  # in coordinates in which the linear part is a rotation
        return np.sum(np.einsum("kij,kj->ki", back, x) ** 2, axis=1)

    # mean of the squared radius over many turns, early and late
    x = np.einsum("kij,j->ki", change, np.array([RADIUS, 0.0]))
    means = []
    for _ in range(2):
        total = np.zeros(COUNT)
        for _ in range(STEPS):
            with np.errstate(over="ignore", invalid="ignore"):
                x = step(x)
                total += size(x)
        means.append(total / STEPS)
    grows = ~(means[1] <= means[0])  # what runs away is no number in the end
    right = 0
    for k in range(COUNT):
        A, Q, C = linear[k], quadratic[k], cubic[k]

        def f(x, p, A=A, Q=Q, C=C):
            return A @ x + np.einsum("ijl,j,l->i", Q, x, x) + np.einsum("ijlm,j,l,m->i", C, x, x, x)

        d, _ = Forms(cv.MapProblem(f, [0.0, 0.0], 0.0), np.zeros(2), 0.0).lyapunov(np.exp(1j * theta[k]))
        assert d.error < 1e-6 * (1.0 + abs(d.value))
        right += bool(d.value > 0.0) == bool(grows[k])
    assert right == COUNT


def test_a_diagram_says_whether_its_pairs_are_super_or_subcritical():
    for sign, word in ((-1.0, "supercritical"), (1.0, "subcritical")):
        flow = cv.AlgebraicProblem(
            lambda u, p, s=sign: np.array([-2 * u[1], 2 * u[0]]) + u * (p + s * (u[0] ** 2 + u[1] ** 2)),
            [0.0, 0.0],
            -0.5,
            spectrum="flow",
        )
        graph = cv.diagram(flow, within=(-1.0, 1.0))
        assert graph["HB1"].criticality == word
        assert graph["HB1"].coefficient == pytest.approx(sign, abs=1e-10)  # l1 = 2 s / omega with |q| = 1
