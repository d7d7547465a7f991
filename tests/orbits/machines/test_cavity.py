"""The cavity: an absorber in one limit, a ball on a shaken table in the other, declared in a file as well."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import brentq

import contvines as cv
from orbits import Absorber, Cavity
from orbits.simulation import simulate
from orbits.theory.manifolds import friction_level, impact_loss, symmetry_limit
from tools.pages.pages import page

LEVEL = {"gravity": 0.211, "mass_ratio": 0.006}


# ---------------------------------------------------------------------------------------------- the absorber
@settings(max_examples=25, deadline=None)
@given(
    amplitude=st.floats(0.1, 2.0),
    phase=st.floats(0.0, 6.0),
    common=st.fixed_dictionaries(
        {
            "restitution": st.floats(0.2, 1.0),
            "friction": st.floats(0.0, 1.0),
            "frequency": st.floats(0.5, 2.0),
        }
    ),
)
def test_level_and_symmetric_it_is_the_absorber_bit_for_bit(amplitude, phase, common):
    start = {"phase": phase, "w": 0.1}
    one, other = (
        simulate(machine(**common, **LEVEL), start, events=40, periods=40, amplitude=amplitude)
        for machine in (Absorber, Cavity)
    )
    assert one.letters == other.letters and np.array_equal(one.rows, other.rows)


def test_symmetry_breaks_where_one_distance_varies():
    """The middle between the walls moves along the branch: its pitchforks are those of the absorber with half the way from wall to wall."""
    right, amplitude, H0 = 1.2, 0.7, friction_level(0.5, LEVEL["gravity"], LEVEL["mass_ratio"])

    def away(left: float) -> float:
        b = 0.5 * (left + right)
        return float(b * symmetry_limit(impact_loss(0.76), H0 / b).amplitude) - amplitude

    machine = Cavity(restitution=0.76, friction=0.5, distance_left=1.0, distance_right=right, **LEVEL)
    orbit = machine.orbit("LR", amplitude=amplitude)
    graph = cv.diagram(orbit, over="distance_left", within=(0.4, 1.4), depth=1)
    assert graph.special["SB1"].value == pytest.approx(brentq(away, 0.2, 1.5), abs=1e-11)


# ---------------------------------------------------------------------------------------------- a ball on a table
GRAVITY, MASS_RATIO, FREQUENCY = 0.7, 0.05, 1.3
WEIGHT = (1.0 + MASS_RATIO) * GRAVITY


def bouncing(table, restitution, periods, amplitude, needed):
    """A motion of the ball that lands once in so many periods of the table: the wall of a cavity that stands upright, or a machine file."""
    if table == "file":
        phase = -math.asin(needed / amplitude)
        guess = [[phase, amplitude * math.cos(phase), WEIGHT * math.pi * periods / FREQUENCY]]
        numbers = {"gravity": WEIGHT, "restitution": restitution, "frequency": FREQUENCY}
        return page("bouncing_ball").orbit("B", periods, guess, amplitude=amplitude, **numbers)
    upright = (
        {"slope": math.pi / 2, "distance_left": 1e4}
        if table == "R"
        else {"slope": -math.pi / 2, "distance_right": 1e4}
    )
    numbers = {"gravity": GRAVITY, "mass_ratio": MASS_RATIO, "frequency": FREQUENCY, "friction": 0.0}
    return Cavity(restitution=restitution, **numbers, **upright).orbit(table, periods, amplitude=amplitude)


@pytest.mark.parametrize("restitution", [0.3, 0.8])
@pytest.mark.parametrize("periods", [1, 2])
@pytest.mark.parametrize("table", ["R", "L", "file"])
def test_a_ball_on_a_sinusoidal_table_folds_and_doubles_at_closed_form_values(restitution, periods, table):
    """One bounce every k periods of the table, table acceleration A Omega^2 over gravity b, T = 2 pi k/Omega.

    Flight: the ball leaves with B+ = -b T/2 and comes back with +b T/2; Newton's law at the table gives
    A Omega^2 cos Psi = -(1 - r)/(1 + r) pi k b, so the motion begins (fold) where the cosine is -1. Linearised once round, with
    x = (1 + r)^2 A Omega^2 sin(Psi)/b, the trace is 1 + r^2 + x and the determinant r^2: +1 at x = 0, -1 at x = -2 (1 + r^2).
    """
    b = WEIGHT / FREQUENCY**2
    fold = (1 - restitution) / (1 + restitution) * math.pi * periods * b
    flip = math.hypot(fold, 2 * b * (1 + restitution**2) / (1 + restitution) ** 2)
    amplitude = 0.5 * (fold + flip)
    orbit = bouncing(table, restitution, periods, amplitude, fold)
    assert orbit.real and orbit.stable and not orbit.symmetric and orbit.replay() < 1e-9
    x = -((1 + restitution) ** 2) * math.sqrt(amplitude**2 - fold**2) / b
    roots = np.roots([1.0, -(1 + restitution**2 + x), restitution**2])
    assert np.abs(np.sort_complex(orbit.multipliers) - np.sort_complex(roots)).max() < 1e-10
    graph = cv.diagram(orbit, over="amplitude", within=(0.9 * fold, 1.1 * flip), depth=0)
    found = {s.kind: s.value for s in graph.special.values()}
    near = 1e-10 if table == "file" else 1e-12 * fold
    assert abs(found["fold"] - fold) < near and abs(found["period-doubling"] - flip) < near
