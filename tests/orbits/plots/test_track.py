"""What moves in a declared machine: bodies where their states are, walls where the page puts them."""

import numpy as np
import pytest

pytest.importorskip("heyoka")

from orbits import Machine, Wall
from orbits.plots.shown import track
from orbits.symbols import cos


def machine(side, shaken=0.0):
    """A mass on a spring with a wall that is shaken itself: at +gap or -gap, plus shaken cos(phase)."""
    return Machine(
        name="stop",
        states=("x", "v"),
        parameters={"forcing": 1.0, "frequency": 2.3, "damping": 0.05, "gap": 0.1, "restitution": 0.8},
        phase_rate="frequency",
        motion=lambda s, phase, p, contact: (s.v, p.forcing * cos(phase) - 2 * p.damping * s.v - s.x),
        contacts=[
            Wall(
                "R",
                gap=lambda s, phase, p: p.gap + side * shaken * cos(phase) - side * s.x,
                push={"v": -float(side)},
                restitution="restitution",
            )
        ],
    )


@pytest.mark.parametrize(("side", "shaken"), [(1, 0.0), (-1, 0.0), (1, 0.02)])
def test_a_wall_stands_where_the_page_puts_it_and_no_body_passes_it(side, shaken):
    orbit = machine(side, shaken).attractor(frequency=2.3).orbit
    motion = orbit.sample(200)
    seen = track(orbit, motion)
    assert list(seen["bodies"]) == ["x"] and seen["periods"] == orbit.periods
    (wall,) = seen["walls"]
    assert (wall["name"], wall["side"]) == ("R", side)
    assert wall["at"] == pytest.approx(side * 0.1 + shaken * np.cos(motion["phase"]), abs=1e-12)
    assert (side * (wall["at"] - seen["bodies"]["x"])).min() > -1e-9
    assert orbit.scene(60)["animation"]["walls"][0]["side"] == side


def test_a_state_that_is_no_rate_moves_nothing():
    orbit = machine(1).attractor(frequency=2.3).orbit
    motion = orbit.sample(200)
    motion["v"] = np.cos(17.0 * motion["time"])
    assert track(orbit, motion) is None
