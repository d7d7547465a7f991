"""Orbits in motion: what the pictures of an animation show, and the files they are written to."""

import numpy as np
import pytest

from tests.machines import ABSORBER


@pytest.fixture(scope="module")
def orbit():
    return ABSORBER.symmetric_orbit(amplitude=0.6)


def test_a_gif_has_so_many_pictures(orbit, tmp_path):
    from PIL import Image

    orbit.animate(tmp_path / "orbit.gif", seconds=0.5, rate=8, figsize=(3, 2))
    with Image.open(tmp_path / "orbit.gif") as picture:
        assert picture.n_frames == 4


def test_the_absorber_stays_between_its_walls(orbit):
    """At every picture the absorber is within the cavity, and at some it touches both walls (to the pictures' distance)."""
    made = orbit.animate(seconds=2.0, rate=20, figsize=(3, 2))
    made._init_draw()  # else matplotlib warns that nobody has looked at it
    above, below = made._fig.axes
    body, *walls = above.lines[1:4]
    assert body.get_color() in [line.get_color() for line in below.lines]  # as in the history
    gaps = []
    for frame in range(40):
        made._func(frame)
        left, right = sorted(wall.get_xdata()[0] for wall in walls)
        gaps.append((body.get_xdata()[0] - left, right - body.get_xdata()[0]))
    gaps = np.array(gaps)
    assert gaps.min() > -0.01 and gaps.min(axis=0).max() < 0.15
    np.testing.assert_allclose(gaps.sum(axis=1), 2.0, atol=1e-9)  # the cavity is two half-widths wide
