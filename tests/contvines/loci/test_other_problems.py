"""Loci and witnesses of problems whose kernels are plain Python: sparse equations, declared machines; what simulation finds."""

import numpy as np
import pytest

import contvines as cv

pytestmark = pytest.mark.slow


def test_loci_of_a_declared_machine_are_their_closed_forms():
    pytest.importorskip("heyoka")
    from tests.contvines.loci.test_absorber_loci import closed_form
    from tools.pages.pages import page

    graph = cv.diagram(
        page("absorber").orbit("LR", amplitude=0.55), over="amplitude", within=(0.2, 0.8), depth=0
    )
    for label, kind in (("LP1", "fold"), ("SB1", "symmetry-breaking")):
        locus = cv.locus(graph[label], over="friction", within=(0.35, 0.65))
        for p, q in locus.values:
            assert p == pytest.approx(closed_form(kind, friction=q), abs=1e-12)


def test_witnesses_name_what_is_stable():
    henon = cv.MapProblem(
        lambda x, p: np.array([1 + x[1] - p.a * x[0] ** 2, p.b * x[0]]),
        [0.6, 0.2],
        {"a": 0.2, "b": 0.3},
        parameter="a",
    )
    # doublings at a = 3 (1 - b)^2 / 4 and (1 - b)^2 + (1 + b)^2 / 4
    assert [m["word"] for m in henon.simulated_attractors(0.1)] == ["1-cycle"]
    assert [m["word"] for m in henon.simulated_attractors(0.5)] == ["2-cycle"]
    flow = cv.AlgebraicProblem(
        lambda u, p: np.array([p.a + p.b * u[0] - u[0] ** 3]),
        [-1.2],
        {"a": 0.0, "b": 1.0},
        parameter="a",
        spectrum="flow",
    )
    both = sorted(m["u"][0] for m in flow.simulated_attractors(0.1))
    roots = sorted(np.roots([-1, 0, 1, 0.1]).real)
    assert both == pytest.approx([roots[0], roots[2]], abs=1e-6)
    assert (
        flow.simulated_attractors(0.9)[0]["kind"] == "equilibrium"
        and len(flow.simulated_attractors(0.9)) == 1
    )
    wheel = cv.AlgebraicProblem(
        lambda u, p: np.array([u[1], -u[0] + p * u[1] - u[0] ** 2 * u[1]]), [0.0, 0.1], 0.5, spectrum="flow"
    )
    assert [m["kind"] for m in wheel.simulated_attractors(0.5)] == ["oscillation"]
    assert "equilibrium" in [m["kind"] for m in wheel.simulated_attractors(-0.5)]
