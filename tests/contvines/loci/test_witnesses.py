"""What simulation finds beside a chart, in words."""

import numpy as np
import pytest

import contvines as cv
from tests.contvines.loci.systems import henon

pytestmark = pytest.mark.slow


def test_witnesses_name_what_is_stable():
    cycles = cv.MapProblem(henon, [0.6, 0.2], {"a": 0.2, "b": 0.3})
    # doublings at a = 3 (1 - b)^2 / 4 and (1 - b)^2 + (1 + b)^2 / 4
    for a, word in ((0.1, "1-cycle"), (0.5, "2-cycle")):
        assert [m["word"] for m in cycles.simulated_attractors(a)] == [word]
    flow = cv.AlgebraicProblem(lambda u, p: p + u - u**3, [-1.2], 0.0, spectrum="flow")
    both = sorted(m["u"][0] for m in flow.simulated_attractors(0.1))
    roots = sorted(np.roots([-1, 0, 1, 0.1]).real)
    assert both == pytest.approx([roots[0], roots[2]], abs=1e-6)
    assert [m["kind"] for m in flow.simulated_attractors(0.9)] == ["equilibrium"]
    wheel = cv.AlgebraicProblem(
        lambda u, p: [u[1], -u[0] + p * u[1] - u[0] ** 2 * u[1]], [0.0, 0.1], 0.5, spectrum="flow"
    )
    assert [m["kind"] for m in wheel.simulated_attractors(0.5)] == ["oscillation"]
    assert "equilibrium" in [m["kind"] for m in wheel.simulated_attractors(-0.5)]
