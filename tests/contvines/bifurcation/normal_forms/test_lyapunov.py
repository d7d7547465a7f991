"""Sign of the first Lyapunov coefficient of drawn maps, decided by iterating them; criticality in a diagram."""

import numpy as np
import pytest

import contvines as cv

COUNT, STEPS, RADIUS = 100, 6000, 0.004


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
