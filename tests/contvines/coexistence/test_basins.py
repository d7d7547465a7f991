"""Shares with their intervals, boundaries, starts sorted by what they reach, values beyond stable stretches: by hand."""

from types import SimpleNamespace

import numpy as np
import pytest

import contvines as cv
from contvines.coexistence.basins import Basins
from contvines.coexistence.maps import MapPopulation


def plane(index, mirrored, shares=()):
    attractors = [SimpleNamespace(share=share, kind="periodic") for share in shares]
    x = np.arange(index.shape[1], dtype=float)
    return Basins(
        "p", 0.5, ("x", "y"), x, np.arange(index.shape[0], dtype=float), {}, index, mirrored, attractors
    )


@pytest.mark.parametrize("share", [0.0, 0.01, 0.37, 1.0])
def test_the_interval_of_a_share_is_wilson_s(share):
    """The shares q with (share - q)^2 = z^2 q (1 - q) / n."""
    n, z2 = 400, 1.96**2
    found = plane(np.zeros((20, 20), int), np.zeros((20, 20), bool), [share]).interval(0)
    roots = np.sort(np.roots([1.0 + z2 / n, -2.0 * share - z2 / n, share**2]).real)
    assert found == pytest.approx(roots, abs=1e-9)


def test_a_motion_and_the_mirror_image_of_another_have_a_boundary():
    """A straight one: the exponent is 1."""
    index = np.zeros((64, 64), int)
    index[:, 32:] = 1
    exponent, _ = plane(index, index == 0).uncertainty_exponent()
    assert exponent == pytest.approx(1.0, abs=0.15)
    with pytest.raises(ValueError, match="one motion alone"):
        plane(np.zeros((64, 64), int), np.zeros((64, 64), bool)).uncertainty_exponent()


def test_a_wall_is_no_boundary_of_a_basin():
    """Points inside a wall reach nothing, so beside one motion alone they have no exponent."""
    index = np.zeros((64, 64), int)
    index[:, 32:] = 1
    basins = plane(index, np.zeros((64, 64), bool), [0.5, 0.5])
    basins.attractors[1].kind = "impossible"
    with pytest.raises(ValueError, match="one motion alone"):
        basins.uncertainty_exponent()


def test_starts_reach_the_fixed_point_on_their_side():
    """x -> 1.5 x - x^3: fixed points +-sqrt(0.5), both with the multiplier 0; starts beyond sqrt(2.5) escape."""
    problem = cv.MapProblem(lambda x, p: p * x - x**3, [0.7], 1.5, scale=1.0)
    starts = np.array([[0.3], [-0.3], [0.9], [-1.0], [5.0], [1.1]])
    motions, index, _ = MapPopulation(problem, [(-2.0, 2.0)]).settle(starts, 1.5)
    assert [motions[k].kind for k in index] == ["periodic"] * 4 + ["escaped", "periodic"]
    ends = [float(motions[k].u[0]) for k in index if motions[k].kind == "periodic"]
    assert ends == pytest.approx(np.sqrt(0.5) * np.array([1.0, -1.0, 1.0, -1.0, 1.0]))
