"""Shares with their intervals, boundaries, starts sorted by what they reach, values beyond stable stretches: by hand."""

from types import SimpleNamespace

import numpy as np
import pytest

import contvines as cv
from contvines.coexistence.basins import Basins
from contvines.coexistence.maps import MapPopulation
from orbits.machines.physical import physical


def plane(index, mirrored, shares=()):
    attractors = [SimpleNamespace(share=share) for share in shares]
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


def test_starts_reach_the_fixed_point_on_their_side():
    """x -> 1.5 x - x^3: fixed points +-sqrt(0.5), both with the multiplier 0; starts beyond sqrt(2.5) escape."""
    problem = cv.MapProblem(lambda x, p: p * x - x**3, [0.7], 1.5, scale=1.0)
    starts = np.array([[0.3], [-0.3], [0.9], [-1.0], [5.0], [1.1]])
    motions, index, _ = MapPopulation(problem, [(-2.0, 2.0)]).settle(starts, 1.5)
    assert [motions[k].kind for k in index] == ["periodic"] * 4 + ["escaped", "periodic"]
    ends = [float(motions[k].u[0]) for k in index if motions[k].kind == "periodic"]
    assert ends == pytest.approx(np.sqrt(0.5) * np.array([1.0, -1.0, 1.0, -1.0, 1.0]))


def test_a_machine_with_units_is_drawn_and_told_in_them():
    """A half-width is 14 mm, and as much in the time of one radian of the free oscillation is 14 mm times 2 pi 8 Hz."""
    case = {
        "oscillator_mass": "3.8 kg", "natural_frequency": "8 Hz", "damping_ratio": 0.007, "absorber_mass": "32 g", "half_width": "14 mm",
        "restitution": 0.6, "friction": 0.1, "base_amplitude": "0.3 mm", "frequency": "7.9 Hz",
    }  # fmt: skip
    found = cv.basins(physical("coupled", case), over="frequency", at=7.9, points=6, fixed={"v": 0.5})
    (axes,) = found.plot().axes
    assert axes.get_xlim() == pytest.approx((14.0, -14.0))
    assert "[mm]" in axes.get_xlabel() and "[mm/s]" in axes.get_ylabel()
    fast = 14.0 * 2.0 * np.pi * 8.0
    assert max(axes.get_ylim()) / fast == pytest.approx(found.y[-1] + 0.5 * (found.y[1] - found.y[0]))
    assert axes.get_title(loc="left") == "frequency = 7.9 Hz" and "frequency = 7.9 Hz" in str(found)
    told = found.to_dict()
    assert told["fixed"]["v"] == pytest.approx(7.0) and told["units"]["v"] == "mm"
    assert told["units"]["frequency"] == "Hz"
