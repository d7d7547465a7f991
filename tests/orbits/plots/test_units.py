"""Pictures of a machine with units are in these units: walls at the half-width, velocities that are rates of the positions."""

import re

import numpy as np
import pytest

from orbits import Cavity
from orbits.machines.physical import physical

CASES = {
    "coupled": {
        "oscillator_mass": "3.8 kg", "natural_frequency": "8 Hz", "damping_ratio": 0.007, "absorber_mass": "32 g", "half_width": "14 mm",
        "restitution": 0.6, "friction": 0.1, "base_amplitude": "0.3 mm", "frequency": "7.9 Hz",
    },
    "absorber": {"half_width": "14 mm", "restitution": 0.7, "friction": 0.1, "amplitude": "9 mm", "frequency": "8 Hz"},
}  # fmt: skip
HERTZ = {"coupled": 7.9, "absorber": 8.0}


@pytest.fixture(params=sorted(CASES))
def orbit(request):
    return request.param, physical(request.param, CASES[request.param]).orbit("LR")


def test_a_report_shows_millimetres(orbit):
    name, one = orbit
    scene = one.scene(2000)
    assert scene["portrait"]["walls"] == scene["animation"]["walls"] == pytest.approx([14.0, -14.0])
    assert np.abs(scene["portrait"]["x"]).max() == pytest.approx(14.0)
    assert "[mm]" in scene["portrait"]["names"][0] and "[mm/s]" in scene["portrait"]["names"][1]
    assert scene["history"]["unit"] == "positions [mm]"
    seconds = scene["history"]["x"] / HERTZ[name]
    w, rate = scene["portrait"]["x"], scene["portrait"]["y"]
    steps = np.diff(seconds)
    inside = steps > 1e-9  # at an event there are two samples
    rises = 0.5 * (rate[1:] + rate[:-1])[inside] * steps[inside]
    np.testing.assert_allclose(np.diff(w)[inside], rises, atol=1e-5 * 14.0)
    apart = scene["history"]["curves"]["cavity"] - scene["history"]["curves"]["absorber"]
    np.testing.assert_allclose(apart, w, atol=1e-9)
    for wall, edge in zip((14.0, -14.0), scene["history"]["walls"]):
        np.testing.assert_allclose(scene["history"]["curves"]["cavity"] - edge, wall)


def test_a_picture_and_a_page_show_the_quantities(orbit):
    name, one = orbit
    figure = one.plot()
    phase, history = figure.axes
    left, right = phase.get_xlim()
    assert left > 14.0 and right < -14.0 and "mm" in phase.get_xlabel() and "mm/s" in phase.get_ylabel()
    assert history.get_ylabel() == "positions [mm]"
    heading = figure.get_suptitle()
    assert "half width = 14 mm" in heading and re.search(r"frequency = (7\.9|8) Hz", heading)
    assert "<td style='text-align:left'>14 mm</td>" in one._repr_html_()


def test_a_machine_of_numbers_is_in_half_widths():
    orbit = physical("coupled", CASES["coupled"]).orbit("LR")
    plain = orbit.model.base(**{name: orbit.parameters[name] for name in orbit.model.base.parameter_names})
    scene = plain.orbit("LR").scene(50)
    assert scene["portrait"]["walls"] == [1.0, -1.0] and scene["history"]["unit"] == "positions in units of b"


def test_unlike_walls_stand_where_they_are():
    machine = Cavity(restitution=0.5, friction=0.5, gravity=0.2, distance_left=0.9)
    orbit = machine.orbit("LR", amplitude=0.6)
    scene = orbit.scene(200)
    assert scene["portrait"]["walls"] == [0.9, -1.0]
    assert np.max(scene["portrait"]["x"]) == pytest.approx(0.9) and np.min(
        scene["portrait"]["x"]
    ) == pytest.approx(-1.0)
    edge = scene["history"]["walls"][0]
    at = [scene["history"]["curves"]["absorber"][0] - edge[0]]
    assert at == pytest.approx([0.0], abs=1e-9)  # the first event is the impact on the left wall
