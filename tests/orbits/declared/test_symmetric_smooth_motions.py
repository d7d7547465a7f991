"""Motions without events that are their own mirror images half a period later: half is solved for, and where they lose this is a symmetry breaking."""

import math

import pytest
from scipy.optimize import brentq

import contvines as cv
from orbits import DryFriction, Machine
from orbits.symbols import cos
from tests.orbits.declared.oscillators import LEFT, RIGHT, oscillator


def machine(gap=None, cubic=1.0, damping=0.1):
    """x'' + damping x' + (1 - cubic) x + cubic x^3 = force cos(t), between two stops if a gap is given."""
    given = {"gap": gap, "restitution": 0.7} if gap else {}
    return oscillator(
        lambda s, phase, p, c: p.force * cos(phase) - damping * s.v - (1.0 - cubic) * s.x - cubic * s.x**3,
        *([LEFT, RIGHT] if gap else []),
        parameters={"force": 0.05, "frequency": 1.0, **given},
        mirror={"L": "R"} if gap else {},
        response="max_abs_x",
    )


def test_ueda_s_oscillator_breaks_its_symmetry():
    """Shooting over half a period by DOP853 and a zero of det(A - 1), A the half map without its mirror: force = 2.2863817."""
    start = machine().attractor(force=0.05).orbit
    assert start.symmetric and start.mirror().symmetric
    graph = cv.diagram(start, over="force", within=(0.02, 6.0), depth=2)
    (broken,) = (point for point in graph.special.values() if point.kind == "symmetry-breaking")
    assert broken.value == pytest.approx(2.2863817, abs=1e-7)
    assert not any(point.kind == "branch-point" for point in graph.special.values())
    assert [b.description["symmetric"] for b in graph.branches.values()] == [True, False, False]
    lost = graph["B2"].orbit(40)
    assert not lost.symmetric and lost.real
    image = lost.mirror()
    assert image.measure("max_x") == pytest.approx(-lost.measure("min_x"), rel=1e-8)
    problem, other = (orbit.problem("force", symmetric=False) for orbit in (lost, image))
    one = problem.canonical(*lost.seed(problem))
    two = other.canonical(*image.seed(other))
    assert one[0] == two[0] and one[1] == pytest.approx(two[1], abs=1e-7)
    assert cv.locus(broken, over="frequency", within=(0.95, 1.05)).values.size > 3


def test_both_stops_are_met_at_once_and_one_by_a_motion_that_lost_its_symmetry():
    """A linear one touches both at force = gap sqrt((1 - W^2)^2 + (damping W)^2)."""
    linear = machine(gap=1.0, cubic=0.0)
    start = linear.orbit("", force=0.1, frequency=1.3)
    graph = cv.diagram(start, over="force", within=(0.05, 0.9), depth=1)
    assert graph["WG1"].value == pytest.approx(math.hypot(1.0 - 1.69, 0.13), rel=1e-9)
    assert graph["B2"].description["symmetric"] and sorted(graph["B2"].description["word"]) == ["L", "R"]
    bent = machine(gap=2.6).attractor(force=3.0).orbit
    graph = cv.diagram(bent, over="force", within=(2.9, 3.6), depth=1)
    border = next(point for point in graph.special.values() if point.kind == "wall-graze")
    assert border.branch == "B1" and "L" in {b.description["word"] for b in graph.branches.values()}


def test_a_body_that_ceases_to_slip_rides_along_without_events():
    """The body is held while the mass under it moves with no more than mu g: w^2 E k / |k - (M + m) w^2 + i c w| = mu g."""
    mass, body, stiffness, damping, base, friction = 3.0, 0.1, 4000.0, 8.0, 0.7e-3, 0.12
    carried = Machine(
        name="carried", states=("q", "x", "v", "u"), phase_rate="frequency", mirror={}, parameters={"frequency": 29.0},
        motion=lambda s, phase, p, c: (
            s.v, s.u, (stiffness * (base * cos(phase) - s.q) - damping * s.v - body * c.floor) / mass, c.floor
        ),
        contacts=[DryFriction("floor", lambda s, phase, p: s.u - s.v, lambda s, phase, p: friction * 9.81)],
    )  # fmt: skip
    graph = cv.diagram(
        carried.attractor(frequency=28.0).orbit, over="frequency", within=(26.0, 29.0), depth=1
    )

    def short(rate):
        response = stiffness - (mass + body) * rate**2 + 1j * damping * rate
        return rate**2 * base * stiffness / abs(response) - friction * 9.81

    (border,) = (point for point in graph.special.values() if point.kind == "stick")
    assert border.value == pytest.approx(brentq(short, 20.0, 30.0), rel=1e-9)
    (held,) = (branch for branch in graph.branches.values() if not branch.description["word"])
    assert held.description["name"] == "no events" and held.description["symmetric"]
