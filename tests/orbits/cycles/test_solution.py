"""What makes an orbit real: every margin, up to rounding."""

import numpy as np
import pytest

import contvines as cv
from orbits import Absorber
from orbits.cycle import is_symmetric
from orbits.simulation.replaying import by_events, replay
from orbits.words import Word
from tools.fuzz.drawing import draw
from tools.fuzz.many_digits import exact
from tools.fuzz.searching import LIMITS

MACHINE = Absorber(restitution=0.76, friction=0.2, gravity=0.211, mass_ratio=0.006)
H = 0.5 * np.pi * 1.006 * 0.2 * 0.211


@pytest.mark.parametrize(
    ("room", "real"), [(1e-3, True), (0.0, True), (-1e-8, False), (-1e-6, False), (-1e-3, False)]
)
def test_pure_sliding_is_real_up_to_the_walls(room, real):
    """It turns at w = -+ sqrt(C^2 - H^2)."""
    orbit = MACHINE.orbit("tt", 1, amplitude=float(np.hypot(1.0 - room, H)))
    assert orbit.real is real
    wall = [margin.value for margin in orbit.margins if margin.kind == "wall"]
    assert wall == pytest.approx([room] * len(wall), abs=1e-12) and wall


@pytest.mark.parametrize(("text", "amplitude"), [("LR", 0.6), ("tt", 0.5)])
def test_multipliers_are_those_of_the_simulated_period(text, amplitude):
    """Eigenvalues of the simulated return map; of a motion without impacts the trivial one is left out."""
    orbit = MACHINE.orbit(text, 1, amplitude=amplitude)
    simulated = replay(orbit, thorough=True).multipliers
    if text == "tt":
        simulated = np.delete(simulated, np.argmin(np.abs(simulated - 1.0)))
    assert np.sort_complex(orbit.multipliers) == pytest.approx(np.sort_complex(simulated), abs=1e-6)
    halves = orbit.half_multipliers**2
    assert np.sort_complex(halves) == pytest.approx(np.sort_complex(orbit.multipliers), abs=1e-10)


def test_a_mirror_image_after_whole_forcing_periods_is_no_symmetry():
    """The mirror turns the forcing round, which half a period on is itself again only if that is an odd number of half turns."""
    nodes = np.array([[0.3, 1.0], [0.3 + 2.0 * np.pi, -1.0]])
    word = Word.parse("LR")
    assert not is_symmetric(word, 2, nodes)
    nodes[1, 0] = 0.3 + np.pi
    assert is_symmetric(word, 1, nodes)
    nodes[1, 0] = 0.3 + 3.0 * np.pi
    assert is_symmetric(word, 3, nodes)


def test_orbits_on_which_rounding_grows_within_a_period_are_replayed_event_by_event():
    """A fold beside a graze of the absorber: deviations grow 1e14 times on the way and shrink again. Many digits say that it is an orbit."""
    drawn = draw("absorber", 404, 339)
    fold = min(
        (p for p in cv.diagram(drawn.orbit, **drawn.options, settings=LIMITS).of_kind("fold")),
        key=lambda p: abs(p.value - 1.8398599),
    )
    orbit = fold.orbit
    known = exact(orbit)
    assert known.moved < 1e-12 and abs(known.shift) < 1e-14
    assert fold.replay == orbit.replay() < 1e-9
    nodes = orbit.nodes.copy()
    nodes[5, 1] += 1e-4
    assert type(orbit)(orbit.model, orbit.word, orbit.periods, nodes, orbit.params).replay() > 5e-5
    through_walls = MACHINE.orbit("tt", 1, amplitude=float(np.hypot(1.01, H)))
    assert by_events(through_walls, 0, 1) == np.inf == through_walls.replay()
