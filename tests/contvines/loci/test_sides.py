"""On which side of a border no motion is: in closed form."""

import numpy as np
import pytest

import contvines as cv


@pytest.mark.parametrize(("slope", "piece", "turned"), [(1.0, 1.0, 1.0), (-1.0, -1.0, 1.0), (1.0, 1.0, -1.0)])
def test_the_side_on_which_the_margin_is_negative(slope, piece, turned):
    """u = s (p - m q), with the piece of one sign of u: it is left across the line p = m q, to where s (p - m q) has the other sign."""
    problem = cv.AlgebraicProblem(
        lambda u, p, sign: [u[0] - turned * (p.p - slope * p.q) - 0.0 * sign["u"]],
        [0.5 * piece],
        {"p": 0.5 * piece * turned, "q": 0.0},
        parameter="p",
        switches={"u": lambda u, p: u[0]},
    )
    graph = cv.diagram(problem, over="p", within=(-1.0, 1.0), depth=0)
    chart = cv.chart(graph, over="q", within=(-0.8, 0.8), regions=False)
    (locus,) = chart.loci.values()
    p, q = locus.values.T
    np.testing.assert_allclose(p, slope * q, atol=1e-9)
    dp, dq = p[-1] - p[0], q[-1] - q[0]
    # a little to that side of the line, as one goes along it in the plane (q, p)
    across = locus.beyond * np.array([-dp, dq])
    assert piece * turned * (across[1] - slope * across[0]) < 0.0
