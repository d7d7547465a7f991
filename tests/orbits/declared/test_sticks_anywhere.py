"""Bodies that always stick, at any place of a band: one alone is followed where it lies; beside one that moves no motion is alone, and the friction is named."""

from pathlib import Path

import pytest

import contvines as cv
from orbits import DryFriction, Machine
from orbits.machines.page.loading import load_page
from orbits.symbols import cos

EXAMPLES = Path(__file__).parents[3] / "examples" / "machines"

MACHINE = Machine(
    name="pair",
    states=("x", "y", "v", "w"),
    parameters={"forcing": 1.0, "frequency": 1.3, "grip": 5.0, "rub": 0.1},
    phase_rate="frequency",
    motion=lambda s, phase, p, contact: (
        s.v,
        s.w,
        s.y - 2 * s.x + contact.grip,
        p.forcing * cos(phase) + s.x - 2 * s.y - 0.3 * s.w + contact.rub,
    ),
    contacts=[
        DryFriction("grip", lambda s, phase, p: s.v, "grip"),
        DryFriction("rub", lambda s, phase, p: s.w, "rub", letters=("T", "S", "U")),
    ],
)


@pytest.mark.parametrize("place", [0.0, 0.2])
def test_the_friction_is_named(place: float) -> None:
    found = MACHINE.attractor({"x": place})
    assert abs(found.orbit.nodes[0, 1] - place) < 1e-12
    assert "'grip'" in found.orbit.problem("forcing").stuck  # said where no step can be made


@pytest.mark.parametrize("place", [0.0, 0.1])
def test_a_body_alone_is_followed_where_it_lies(place: float) -> None:
    """The spring takes `place` of the friction; it slips where the forcing takes the rest."""
    machine = load_page(EXAMPLES / "den_hartog.py", "machine")
    rest = machine.attractor({"x": place}, forcing=0.1).orbit
    graph = cv.diagram(rest, over="forcing", within=(0.02, 0.6), depth=0)
    assert graph["ST1"].branch == "B1"
    assert abs(graph["ST1"].value - (0.3 - place)) < 1e-9
