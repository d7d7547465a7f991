"""Two bodies on dry ground, one of which always sticks: each place of it has a motion of the other, so none is alone."""

import pytest

import contvines as cv
from orbits import DryFriction, Machine
from orbits.symbols import cos

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
def test_no_branch_of_such_motions(place: float) -> None:
    found = MACHINE.attractor({"x": place})
    assert abs(found.orbit.nodes[0, 1] - place) < 1e-12
    with pytest.raises(ValueError, match="'grip' sticks all the time"):
        cv.diagram(found.orbit, over="forcing", within=(0.9, 1.1), depth=0)
