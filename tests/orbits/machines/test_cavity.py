"""The cavity: an absorber in one limit, a ball on a shaken table in the other, and independent integration in between."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import brentq

import contvines as cv
from orbits import Absorber, Cavity
from orbits.simulation import simulate
from orbits.starts.find import StartError
from orbits.theory.manifolds import friction_level, impact_loss, symmetry_limit

LEVEL = {"gravity": 0.211, "mass_ratio": 0.006}


# ---------------------------------------------------------------------------------------------- the absorber
@settings(max_examples=25, deadline=None)
@given(
    restitution=st.floats(0.2, 1.0),
    friction=st.floats(0.0, 1.0),
    frequency=st.floats(0.5, 2.0),
    amplitude=st.floats(0.1, 2.0),
    phase=st.floats(0.0, 6.0),
)
def test_level_and_symmetric_it_is_the_absorber_bit_for_bit(
    restitution, friction, frequency, amplitude, phase
):
    common = {"restitution": restitution, "friction": friction, "frequency": frequency, **LEVEL}
    runs = [
        simulate(machine(**common), {"phase": phase, "w": 0.1}, events=40, periods=40, amplitude=amplitude)
        for machine in (Absorber, Cavity)
    ]
    assert runs[0].letters == runs[1].letters
    assert np.array_equal(runs[0].rows, runs[1].rows)


def test_level_with_unlike_distances_its_graph_is_the_absorbers_in_other_units():
    """All words, and borders where events off the walls begin: the graph of the absorber with b = (d_L + d_R)/2, C and g as C/b and g/b."""
    left, right = 0.9, 1.3
    b = 0.5 * (left + right)
    absorber = Absorber(restitution=0.76, friction=0.5, **LEVEL)
    scaled = {**LEVEL, "gravity": b * LEVEL["gravity"], "distance_left": left, "distance_right": right}
    cavity = Cavity(restitution=0.76, friction=0.5, **scaled)
    graphs = [
        cv.diagram(
            machine.orbit("LR", amplitude=0.6 * unit), over="amplitude", within=(0.15 * unit, 1.1 * unit)
        )
        for machine, unit in ((absorber, 1.0), (cavity, b))
    ]
    listed = [
        [(branch.description["word"], branch.real, branch.description["symmetric"]) for branch in graph]
        for graph in graphs
    ]
    assert listed[0] == listed[1] and len({word for word, *_ in listed[0]}) > 4
    assert [point.label for point in graphs[0].special.values()] == [
        point.label for point in graphs[1].special.values()
    ]
    for one, other in zip(graphs[0].special.values(), graphs[1].special.values()):
        assert other.value == pytest.approx(b * one.value, abs=1e-9), one.label
    asymmetric = next(branch for branch in graphs[1] if not branch.description["symmetric"] and branch.real)
    orbit, image = asymmetric.orbit(3), asymmetric.orbit(3).mirror()
    assert (
        image.residual < 1e-10
        and image.real
        and np.abs(image.positions(200) - orbit.positions(200)).max() > 1e-3
    )
    # seen from the middle the image is on the other side, half a period later
    assert image.positions(200) + np.roll(orbit.positions(200), 100) == pytest.approx(left - right, abs=1e-10)


def test_symmetry_breaks_where_one_distance_varies():
    """The middle between the walls moves along the branch: its pitchforks are those of the absorber with half the way from wall to wall."""
    right, amplitude, H0 = 1.2, 0.7, friction_level(0.5, LEVEL["gravity"], LEVEL["mass_ratio"])
    R = impact_loss(0.76)

    def away(left: float) -> float:
        b = 0.5 * (left + right)
        return float(b * symmetry_limit(R, H0 / b).amplitude) - amplitude

    expected = brentq(away, 0.2, 1.5)
    machine = Cavity(restitution=0.76, friction=0.5, distance_left=1.0, distance_right=right, **LEVEL)
    orbit = machine.orbit("LR", amplitude=amplitude)
    graph = cv.diagram(orbit, over="distance_left", within=(0.4, 1.4), depth=1)
    assert graph.special["SB1"].value == pytest.approx(expected, abs=1e-11)


# ---------------------------------------------------------------------------------------------- a ball on a table
@pytest.mark.parametrize("restitution", [0.3, 0.8])
@pytest.mark.parametrize("periods", [1, 2])
@pytest.mark.parametrize("side", [1, -1])
def test_a_ball_on_a_sinusoidal_table_folds_and_doubles_at_closed_form_values(restitution, periods, side):
    """One bounce every k periods of the table, table acceleration A Omega^2 over gravity b, T = 2 pi k/Omega.

    Flight: the ball leaves with B+ = -b T/2 and comes back with +b T/2; Newton's law at the table gives
    A Omega^2 cos Psi = -(1 - r)/(1 + r) pi k b, so the motion begins (fold) where the cosine is -1. Linearised once round, with
    x = (1 + r)^2 A Omega^2 sin(Psi)/b, the trace is 1 + r^2 + x and the determinant r^2: +1 at x = 0, -1 at x = -2 (1 + r^2).
    """
    machine = Cavity(
        restitution=restitution,
        friction=0.0,
        gravity=0.7,
        mass_ratio=0.05,
        frequency=1.3,
        slope=side * 0.5 * math.pi,
        **{"distance_left" if side > 0 else "distance_right": 1e4},
    )
    b = 1.05 * 0.7 / 1.3**2
    cosine = (1 - restitution) / (1 + restitution) * math.pi * periods * b
    fold, flip = cosine, math.hypot(cosine, 2 * b * (1 + restitution**2) / (1 + restitution) ** 2)
    orbit = machine.orbit("R" if side > 0 else "L", periods, amplitude=0.5 * (fold + flip))
    assert orbit.real and orbit.stable and not orbit.symmetric and orbit.replay() < 1e-11
    sine = math.sin(orbit.nodes[0, 0])
    x = side * (1 + restitution) ** 2 * orbit.parameters["amplitude"] * sine / b
    roots = np.roots([1.0, -(1 + restitution**2 + x), restitution**2])
    assert np.abs(np.sort_complex(orbit.multipliers) - np.sort_complex(roots)).max() < 1e-10
    graph = cv.diagram(orbit, over="amplitude", within=(0.9 * fold, 1.1 * flip), depth=0)
    found = {s.kind: s.value for s in graph.special.values()}
    assert abs(found["fold"] - fold) < 1e-12 * fold
    assert abs(found["period-doubling"] - flip) < 1e-12 * flip


def test_an_inclined_cavity_has_no_symmetry_breaking():
    machine = Cavity(restitution=0.76, friction=0.5, slope=0.02, **LEVEL)
    graph = cv.diagram(machine.orbit("LR", amplitude=0.55), over="amplitude", within=(0.2, 0.85), depth=1)
    kinds = {s.kind for s in graph.special.values()}
    assert "symmetry-breaking" not in kinds and "branch-point" not in kinds and "fold" in kinds


def test_at_rest_on_a_wall_it_says_that_there_is_nothing_to_follow():
    machine = Cavity(
        restitution_left=0.5, restitution_right=0.5, friction=0.1, gravity=0.3, slope=0.5, mass_ratio=0.0
    )
    run = machine.simulate(periods=60, amplitude=0.05)
    assert run.end[1] == pytest.approx(-1.0, abs=1e-6)  # it lies on the right wall
    with pytest.raises(StartError, match="gravity pulls it to a wall and keeps it there"):
        machine.orbit("", amplitude=0.05)
