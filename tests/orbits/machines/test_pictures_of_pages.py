"""Pictures and scenes of motions of declared machines: on given axes, small, and as numbers."""

import matplotlib as mpl
import numpy as np
import pytest

pytest.importorskip("heyoka")

from orbits import Machine, Wall
from orbits.symbols import cos


@pytest.fixture(scope="module")
def orbit():
    """x'' + x = cos(w t) with a rigid stop at x = 0, hit once in a forcing period."""

    def motion(state, phase, p, contact):
        x, v = state
        return v, cos(phase) - x

    machine = Machine(
        name="stop",
        states=("x", "v"),
        parameters={"frequency": 2.3, "restitution": 0.8},
        phase_rate="frequency",
        motion=motion,
        contacts=[
            Wall("R", gap=lambda state, phase, p: -state.x, push={"v": -1.0}, restitution="restitution")
        ],
    )
    return machine.orbit("R", 1)


def test_without_axes_a_figure_that_a_notebook_shows(orbit):
    figure = orbit.plot()
    assert len(figure.axes) == 2 and "R, 1 impact in 1 forcing period" in figure.get_suptitle()
    assert figure._repr_png_()[:4] == b"\x89PNG"
    assert len(orbit.plot(figsize=(3.4, 2.4)).axes) == 1  # the phase portrait alone


def test_given_axes_are_drawn_on(orbit):
    figure = mpl.figure.Figure()
    one, two = figure.subplots(1, 2)
    assert orbit.plot(axes=[one, two]) is figure
    assert one.lines and two.lines and figure.get_suptitle() == ""


def test_a_scene_is_the_motion_between_its_events(orbit):
    scene = orbit.scene(200)
    (event,) = scene["events"]
    assert event["event"] == "R" and abs(event["x"]) < 1e-12
    x, v = np.array(scene["portrait"]["x"]), np.array(scene["portrait"]["y"])
    assert event["y"] == pytest.approx(v[0], abs=1e-9) and v[0] == pytest.approx(-0.8 * v[-1], rel=1e-9)
    # x'' + x = cos(psi): between impacts a cos t + b sin t + cos(psi)/(1 - w^2)
    w = orbit.parameters["frequency"]
    psi = 2 * np.pi * np.array(scene["history"]["x"])
    t = (psi - psi[0]) / w
    forced = np.cos(psi) / (1 - w * w)
    a, b = x[0] - forced[0], v[0] + w * np.sin(psi[0]) / (1 - w * w)
    assert np.abs(a * np.cos(t) + b * np.sin(t) + forced - x).max() < 1e-9
