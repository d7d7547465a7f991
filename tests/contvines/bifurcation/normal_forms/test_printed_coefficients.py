"""Coefficients beside those that another package prints."""

import numpy as np
import pytest
from scipy.optimize import fsolve

import contvines as cv
from contvines.loci.codimension_two import coefficients, find

pytestmark = pytest.mark.slow


def lorenz(u, F, T):
    """Extended Lorenz-84 (Shilnikov, Nicolis and Nicolis 1995; Kuznetsov, Meijer and van Veen 2004), parameters of BifurcationKit's test."""
    X, Y, Z, U = u
    return [
        -Y * Y - Z * Z - X / 4 + F / 4 - 0.987 * U * U,
        X * Y - X * Z - Y + 0.25,
        X * Y + X * Z - Z,
        -1.04 * U + 0.987 * U * X + T,
    ]


def double_zero(v):
    """The equations, and the two lowest coefficients of the characteristic polynomial."""
    X, Y, Z, U, F, T = v
    J = [
        [-0.25, -2 * Y, -2 * Z, -2 * 0.987 * U],
        [Y - Z, X - 1, -X, 0],
        [Y + Z, X, X - 1, 0],
        [0.987 * U, 0, 0, 0.987 * X - 1.04],
    ]
    return [*lorenz(v[:4], F, T), *np.poly(np.array(J))[3:].real]


def test_extended_lorenz_84_as_printed():
    """Values of BifurcationKit's test test/hopf_codim_2/lorenz84.jl: a and b at a Bogdanov-Takens point that it solves for (T of that point, 0.02058724,
    is printed where it was detected, two per cent off), l2 and omega at a generalized Hopf point; its l2 is that of the rate of w, ours is divided by omega."""
    start = [2.9787, -0.038683, 0.0582327, -0.0210529]
    problem = cv.AlgebraicProblem(
        lambda u, p: lorenz(u, p.F, p.T), start, {"F": 3.0, "T": 0.04}, spectrum="flow"
    )
    graph = cv.diagram(problem, over="F", within=(1.0, 3.0), depth=0)
    hopf, (fold,) = graph.of_kind("hopf"), graph.of_kind("fold")
    values = sorted(s.value for s in (*hopf, fold))
    assert values == pytest.approx([1.54664837, 1.61966, 2.46723, 2.85988], abs=2e-5)

    def points_on(special):
        return [p for _, p in find(cv.locus(special, over="T", within=(-0.1, 0.1), bounds=(1.0, 3.0)))]

    points = points_on(fold)
    kinds = [p.kind for p in points]
    assert kinds == ["bogdanov-takens", "zero-hopf", "cusp", "zero-hopf", "bogdanov-takens"]
    for point in (points[0], points[-1]):
        exact = fsolve(double_zero, [*point.u, *point.value], xtol=1e-14)[4:]
        assert point.value == pytest.approx(exact, abs=1e-11)
        found = {name: abs(value) for name, value in coefficients(point).items()}
        assert found == pytest.approx({"a": 0.2144233509273467, "b": 0.6065145518280868}, rel=1e-8)
    points = points_on(min(hopf, key=lambda s: abs(s.value - 2.46723)))
    assert {"generalized-hopf", "double-hopf"} <= {p.kind for p in points}
    bautin = [coefficients(p) for p in points if p.kind == "generalized-hopf"]
    nearest = min(bautin, key=lambda c: abs(c["omega"] - 0.6903636672622595))
    assert nearest["omega"] == pytest.approx(0.6903636672622595, abs=1e-5)
    # their own tolerance
    assert nearest["l2"] * nearest["omega"] == pytest.approx(0.15555332623343107, abs=1e-3)
