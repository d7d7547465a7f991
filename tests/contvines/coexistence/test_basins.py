"""Shares with their intervals, boundaries, starts sorted by what they reach: by hand."""

from types import SimpleNamespace

import numpy as np
import pytest

import contvines as cv
from contvines.coexistence.basins import Basins


def plane(index, mirrored=False, kinds=(), share=0.5):
    """Basins of a plane of 64 x 64 starts by what they reach."""
    attractors = [SimpleNamespace(share=share, kind=kind) for kind in kinds]
    both, at = np.zeros((2, 64, 64), int) + np.array([index, mirrored]).reshape(2, 1, -1), np.arange(64.0)
    return Basins("p", 0.5, ("x", "y"), at, at, {}, both[0], both[1] > 0, attractors)


@pytest.mark.parametrize("share", [0.0, 0.01, 0.37, 1.0])
def test_the_interval_of_a_share_is_wilson_s(share):
    """The shares q with (share - q)^2 = z^2 q (1 - q) / n."""
    n, z2 = 64**2, 1.96**2
    found = plane([0] * 64, [0] * 64, ["periodic"], share).interval(0)
    roots = np.sort(np.roots([1.0 + z2 / n, -2.0 * share - z2 / n, share**2]).real)
    assert found == pytest.approx(roots, abs=1e-9)


def test_boundaries_of_basins():
    """Straight ones: the exponent is 1. Points inside a wall reach nothing, so beside one motion alone they have no exponent."""
    halves, none = [0] * 32 + [1] * 32, [0] * 64
    for index, mirrored in ((halves, none), (none, halves)):
        exponent, _ = plane(index, mirrored, ["periodic", "periodic"]).uncertainty_exponent()
        assert exponent == pytest.approx(1.0, abs=0.15)
    for index, kinds in ((none, ["periodic"]), (halves, ["periodic", "impossible"])):
        with pytest.raises(ValueError, match="one motion alone"):
            plane(index, none, kinds).uncertainty_exponent()


def test_starts_reach_the_fixed_point_on_their_side():
    """x -> 1.5 x - x^3: fixed points +-sqrt(0.5), both with the multiplier 0; starts beyond sqrt(2.5) escape."""
    problem = cv.MapProblem(lambda x, p: p * x - x**3, [0.7], 1.5, scale=1.0)
    starts = np.array([[0.3], [-0.3], [0.9], [-1.0], [5.0], [1.1]])
    motions, index, _ = problem.population(box=[(-2.0, 2.0)]).settle(starts, 1.5)
    assert [motions[k].kind for k in index] == ["periodic"] * 4 + ["escaped", "periodic"]
    ends = [float(motions[k].u[0]) for k in index if motions[k].kind == "periodic"]
    assert ends == pytest.approx(np.sqrt(0.5) * np.array([1.0, -1.0, 1.0, -1.0, 1.0]))
