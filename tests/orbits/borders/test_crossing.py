"""What counts as an orbit beyond a border: every margin kept, and followed by the simulation."""

import numpy as np
import pytest

import contvines as cv
from orbits import Absorber, Cavity
from orbits.borders.neighbours import BranchAtBorder, followed
from orbits.borders.rewriting import edits_at
from orbits.orbit import Orbit
from orbits.words import Word
from tests.machines import ABSORBER

MACHINE = ABSORBER.changed(friction=0.2)
H = 0.5 * np.pi * 1.006 * 0.2 * 0.211
ROOMS = {1e-3: True, 1e-6: True, 1e-12: True, -1e-14: True, -1e-11: False, -1e-8: False, -1e-3: False}


@pytest.mark.parametrize(("room", "real"), ROOMS.items())
def test_pure_sliding_is_real_up_to_the_walls(room, real):
    """It turns at w = -+ sqrt(C^2 - H^2). Orbit, branch and border agree on what is real; at a border a margin is zero to rounding.

    The simulation that hits a wall so slowly still stays within a millionth.
    """
    orbit = MACHINE.orbit("tt", 1, amplitude=float(np.hypot(1.0 - room, H)))
    (wall,) = (margin.value for margin in orbit.margins if margin.kind == "wall")
    assert wall == orbit.margin == pytest.approx(room, abs=1e-12)
    assert orbit.real is real is all(margin.value >= 0.0 for margin in orbit.margins)
    problem = orbit.problem()
    assert followed(BranchAtBorder(problem, *orbit.seed(problem), None).orbit()) is real
    options = {"over": "amplitude", "within": (0.9, 1.1), "depth": 0}
    if not real:
        with pytest.raises(ValueError, match="beyond a border"):
            cv.diagram(orbit, **options)
    graph = cv.diagram(orbit, **options, virtual=True)
    branch, border = graph["B1"], graph["WG1"]
    assert border.real and border.orbit.real and border.orbit.margin == pytest.approx(0.0, abs=1e-14)
    assert branch.real is real
    assert all(branch.orbit(i).real is real for i in range(1, len(branch) - 1))


def test_what_does_not_come_near_a_border_says_nothing_about_it():
    """Solutions with the new word lay far from the border; the doubled motion that leaves there was taken for impossible (simulation follows it)."""
    machine = Cavity(
        restitution_left=0.90245, restitution_right=0.33234, friction_left=0.6393, friction_right=0.47904,
        gravity=0.06493, slope=0.23613, distance_left=0.85383, distance_right=1.30786,
    )  # fmt: skip
    start = machine.orbit("LRtRtt", amplitude=0.951)
    graph = cv.diagram(start, over="amplitude", within=(0.95, 0.96), depth=2)
    doubled = next(branch for branch in graph if branch.description["periods"] == 4)
    assert doubled.real and doubled.orbit(5).replay() < 1e-7


def test_without_friction_a_motion_starts_over_friction():
    machine = Absorber(restitution=0.9, friction=0.0, gravity=0.27, mass_ratio=0.05)
    graph = cv.diagram(machine.attractor(amplitude=0.9), over="friction", within=(0.0, 0.07), depth=1)
    settled = machine.changed(friction=0.05).attractor(amplitude=0.9)
    assert graph["B2"].description["word"] == settled.word.text


@pytest.mark.parametrize(("side", "walls"), [(1.0, ["R", "L"]), (-1.0, [])])
def test_turns_near_the_walls_that_were_left_hit_none(side, walls):
    """Sliding to the left ends at w = 1, to the right at w = -1."""
    nodes = np.array([[0.3, -side], [3.4, side]])
    border = Orbit(MACHINE, Word.parse("tt"), 1, nodes, MACHINE.vector({"amplitude": 0.8}))
    edits = [edit for place in (0, 1) for edit in edits_at(border, 4 * place + 2)]
    assert [event for edit in edits for event in edit.change.events] == walls
