"""Why nothing goes on at a border: said where it is known, and confirmed by the simulator."""

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.optimize import brentq

import contvines as cv
from orbits import Absorber, Cavity
from orbits.attractors import find_attractor
from orbits.simulation import simulate

pytestmark = pytest.mark.slow


def test_on_a_slope_a_motion_at_rest_creeps_to_a_wall():
    """Beyond the border shaking beats friction once in a period, in one direction: the way is that of a slipping block, and is never taken back."""
    machine = Cavity(restitution=0.5, friction=0.9, gravity=0.8, slope=0.15, distance_left=1.4)
    graph = cv.diagram(machine.orbit("", amplitude=0.2), over="amplitude", within=(0.1, 1.0), depth=1)
    border = graph.of_kind("stick")[0]
    # friction less slope: the smaller of the two pulls is what a push has to beat
    pull = 0.8 * (0.9 * np.cos(0.15) - np.sin(0.15))
    assert border.value == pytest.approx(pull, abs=1e-12)
    assert len(border.remarks) == 1 and "creeps" in border.remarks[0] and len(graph.branches) == 1
    assert simulate(machine, {"w": 0.5}, periods=400, amplitude=border.value * 0.99).codes.size == 0
    for excess in (1e-4, 1e-3, 3e-2):
        amplitude = (1.0 + excess) * pull
        begin = np.arcsin(pull / amplitude)

        def speed(psi, amplitude=amplitude, begin=begin):
            return amplitude * (np.cos(begin) - np.cos(psi)) - pull * (psi - begin)

        end = brentq(speed, np.pi - begin + 1e-9, 2.0 * np.pi)
        way = quad(speed, begin, end, epsabs=1e-15)[0]
        places = simulate(machine, {"w": 0.5}, periods=20, amplitude=amplitude).sample(per_period=1).w
        assert np.diff(places[2:-1]) == pytest.approx(-way, rel=1e-6)
        found = find_attractor(machine, {"w": 0.5}, amplitude=amplitude)
        assert found.kind == "stuck" and found.state[1] == pytest.approx(-1.0, abs=1e-9)


def test_impacts_that_pile_up_are_told_with_the_speed_of_the_slowest():
    machine = Absorber(restitution=0.0535032, friction=0.65425996, gravity=0.16014476)
    orbit = find_attractor(machine, {"w_rate": 1.0}, amplitude=1.11).orbit
    graph = cv.diagram(orbit, over="amplitude", within=(1.1, 1.14), depth=0)
    last = next(p for p in graph.special.values() if any("pile up" in text for text in p.remarks))
    assert not [s for s in graph.switches if s.source == last.branch and s.point == last.label]
    told = float(last.remarks[0].split("slowest has ")[1].split(" of")[0])
    # the simulator's own run beside it: the slowest impact that it sees after the slowest of the orbit is lost in rounding
    run = simulate(machine, {"w_rate": 1.0}, periods=200, amplitude=last.value - 1e-9)
    speeds = np.sort(np.abs(run.rows[run.codes < 2][-40:, 3]))
    assert np.abs(np.log(speeds / told)).min() < 0.2


def test_a_stick_at_a_wall_that_is_about_to_let_go():
    """An impact before the stick leaves it no time: the faster it is the later the stick begins, which slips all the same.

    The bounce, of speed e v, is stopped by what friction has in reserve; that falls to zero while the stick lasts, so at most half
    of their product can be stopped, and beyond that speed nothing sticks any more.
    """
    machine = Cavity(
        restitution_left=0.10878892263744645, restitution_right=0.25829327142907893,
        friction_left=0.5846013783532008, friction_right=0.9782221629612905, gravity=0.09286117259912385,
        slope=-0.1018551716670123, distance_left=1.3115605198765397, distance_right=0.6283660446726224, mass_ratio=0.05,
    )  # fmt: skip
    nodes = [
        [7.604171, 0.1722621], [10.7135632, 0.2175675], [13.1994779, 0.4974531], [16.8319832, -0.3302381],
        [20.4632948, -0.0088317], [23.0336773, 0.6522921], [24.7218903, 0.5827504], [25.0388672, 1.3008158],
        [25.0568628, 1.3008161], [25.3237705, 1.3008161], [29.3665538, -0.3503809],
    ]  # fmt: skip
    start = machine.orbit("LtLRLtLtsR", periods=4, guess=nodes, amplitude=0.5519612510246895)
    graph = cv.diagram(start, over="amplitude", within=(0.5519, 0.554), depth=1)
    told = [text for point in graph.special.values() for text in point.remarks if "about to vanish" in text]
    assert len(told) == 1 and "1.5e-04" in told[0] and "1.3e-04" in told[0]
