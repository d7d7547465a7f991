"""Declared machines against closed forms, each derived in its docstring."""

import math

import mpmath as mp
import numpy as np
import pytest
from scipy.optimize import brentq

import contvines as cv
from orbits import Switch, Wall
from orbits.symbols import cos
from tests.orbits.declared.oscillators import FLOOR, RIGHT, oscillator
from tools.pages.pages import page


def values(graph, kind):
    return [point.value for point in graph.of_kind(kind)]


# ---------------------------------------------------------------------------------------------- impacts
def single_impact(frequency, restitution):
    """(phase, speed after the impact, multipliers' trace) of x'' + x = cos(W t) with one impact per period.

    x = A cos t + B sin t + g cos(W t + f), g = 1/(1 - W^2), from x(0) = x(T) = 0 and x'(0) = -e x'(T):
    A = -g cos f, B = A tan(T/2), and g W sin f = A tan(T/2) (1 - e)/(1 + e).
    """
    W, e = mp.mpf(frequency), mp.mpf(restitution)
    T, g, R = 2 * mp.pi / W, 1 / (1 - W**2), (1 - e) / (1 + e)
    t = mp.tan(T / 2)

    def speed(f):
        return -g * (mp.cos(f) * t + W * mp.sin(f))

    f = mp.atan2(-t * R, W)
    f = min(f, f + mp.pi, key=speed)  # away from the wall
    v = speed(f)

    def x(s, phase, speed):
        B = speed + g * W * mp.sin(phase)
        return B * mp.sin(s) + g * (mp.cos(W * s + phase) - mp.cos(phase) * mp.cos(s))

    def slope(*orders):
        return mp.diff(x, (T, f, v), orders)

    later = [-slope(*n) / slope(1, 0, 0) for n in ((0, 1, 0), (0, 0, 1))]
    return f, v, 1 + W * later[0] - e * (slope(1, 0, 1) + slope(2, 0, 0) * later[1])


def test_single_impact_orbits_their_multipliers_and_what_they_meet():
    """The impact meets a switch whose force is zero where that has its phase."""
    machine = oscillator(
        lambda s, phase, p, contact: cos(phase) - s.x + p.push * contact.half, RIGHT,
        Switch("half", lambda s, phase, p: cos(phase - p.late)),
        parameters={"frequency": 2.3, "restitution": 0.8, "gap": 0.0, "push": 0.0, "late": 0.0},
    )  # fmt: skip
    with mp.workdps(30):
        f, v, trace = single_impact(2.3, 0.8)
    orbit = machine.attractor().orbit
    graph = cv.diagram(orbit, over="late", within=(0.0, np.pi), depth=1)
    assert values(graph, "corner") == pytest.approx([float(f + mp.pi / 2) % np.pi], abs=1e-10)
    assert len(graph) == 2 and orbit.real
    assert math.cos(orbit.nodes[0, 0] - float(f)) == pytest.approx(1.0, abs=1e-14)
    assert orbit.nodes[0, 2] == pytest.approx(float(v), abs=1e-12)
    assert orbit.multipliers.sum().real == pytest.approx(float(trace), abs=1e-11)
    assert np.prod(orbit.multipliers).real == pytest.approx(0.64, abs=1e-12)  # e^2: nothing else dissipates


def test_period_doubling_of_the_impact_oscillator():
    """A multiplier -1: 1 + trace + e^2 = 0."""
    machine = page("impact_oscillator")
    with mp.workdps(30):
        exact = mp.findroot(lambda W: 1 + single_impact(W, mp.mpf("0.8"))[2] + mp.mpf("0.64"), (2.6, 2.7))
    graph = cv.diagram(machine.attractor(frequency=2.3), over="frequency", within=(2.2, 2.7), depth=0)
    assert values(graph, "period-doubling") == pytest.approx([float(exact)], abs=1e-10)


def test_the_fold_of_a_bounce_with_quadratic_drag():
    """Drag turns with the velocity, which an impact turns at once: it jumps over the surface of the switch.

    One bounce a period: up with v0, down with v1, and the table moves with (v0 - e v1)/(1 + e) there, at most A W.
    With g = c the drag is g at the speed 1. Up: v = tan, over v0 in the time atan(v0)/g, to the height ln(1 + v0^2)/(2 g).
    Down from there: v1^2 = 1 - 1/(1 + v0^2), in the time atanh(v1)/g.
    """
    ball = oscillator(
        lambda s, phase, p, contact: -0.1 - 0.1 * s.v**2 * contact.up,
        Wall("B", lambda s, phase, p: s.x - p.amplitude * cos(phase), {"v": 1.0}, 0.8),
        Switch("up", surface=lambda s, phase, p: s.v),
        parameters={"amplitude": 0.07, "frequency": 1.0},
    )

    def landing(v0):
        return v0 / math.hypot(1, v0)

    def late(v):
        return (math.atan(v) + math.atanh(landing(v))) / 0.1 - 2 * math.pi

    v0 = brentq(late, 0.1, 1.0, xtol=1e-15)
    exact = (v0 - 0.8 * landing(v0)) / 1.8
    start = ball.attractor({"x": 0.1, "v": 0.33, "phase": -0.8})
    assert start.word.text == "B up-" and start.orbit.real and start.orbit.replay() < 1e-10
    graph = cv.diagram(start, over="amplitude", within=(0.02, 0.09), depth=0)
    assert values(graph, "fold") == pytest.approx([exact], abs=1e-10)


# ---------------------------------------------------------------------------------------------- friction and soft stops
def reach(W, friction):
    """How far x'' + x = cos(W t) - friction sign(x') goes without sticks (J. P. Den Hartog, Trans. ASME 53 (1931) APM-53-9)."""
    U = math.sin(math.pi / W) / (W * (1 + math.cos(math.pi / W)))
    return math.sqrt((1 / (1 - W**2)) ** 2 - (friction * U) ** 2)


@pytest.mark.parametrize(("W", "f"), [(0.8, 0.3), (0.62, 0.45)])
def test_den_hartogs_onset_of_sticking(W, f):
    """At a turn the shaking beats friction while it reaches further than f/W^2."""
    start = page("den_hartog").attractor(frequency=W, friction=f)
    assert np.abs(start.orbit.nodes[:, 1]).max() == pytest.approx(reach(W, f), abs=1e-11)
    graph = cv.diagram(start, over="forcing", within=(0.35, 1.1), depth=0)
    exact = brentq(lambda F: F * reach(W, f / F) - f / W**2, 0.35, 1.1, xtol=1e-14)
    assert min(abs(value - exact) for value in values(graph, "stick")) < 1e-10
    assert graph["B1"].description["word"] == "tt"


@pytest.mark.slow
@pytest.mark.parametrize(("gap", "friction"), [(1.6, 0.3), (2.2, 0.45)])
def test_a_turn_grazes_a_soft_stop_where_den_hartogs_amplitude_is_its_distance(gap, friction):
    def force(s, phase, p, contact):
        pressed = (1 + contact.stop) / 2
        return cos(phase) - s.x - 4.0 * (s.x - p.gap) * pressed + contact.floor

    numbers = {"frequency": 0.5, "friction": friction, "gap": gap}
    machine = oscillator(force, Switch("stop", lambda s, phase, p: s.x - p.gap), FLOOR, parameters=numbers)
    graze = brentq(lambda W: reach(W, friction) - gap, 0.5, 0.95, xtol=1e-14)
    for start in (graze - 0.02, graze + 0.02):
        orbit = machine.attractor(frequency=start)
        graph = cv.diagram(orbit, over="frequency", within=(graze - 0.03, graze + 0.03), depth=1)
        (point,) = graph.of_kind("switch-graze")
        assert point.value == pytest.approx(graze, abs=1e-10)
        words = {machine.word(b.description["word"]).canonical().events for b in graph}
        assert {machine.word("stop+ t stop- t").canonical().events} < words
        joined = {label for s in graph.switches if s.point == point.label for label in (s.source, s.target)}
        assert len(joined) == 2


@pytest.mark.parametrize(("F", "D", "gap"), [(0.5, 0.05, 1.0), (0.3, 0.02, 1.4), (0.8, 0.12, 0.9)])
def test_grazing_of_the_elastic_stop(F, D, gap):
    """The linear motion touches the stop where its amplitude F/|1 - W^2 + 2 i D W| is the gap."""
    machine = page("elastic_stop")
    square = np.roots([1.0, 4 * D**2 - 2.0, 1.0 - (F / gap) ** 2])
    exact = math.sqrt(square.max())
    start = machine.attractor(frequency=1.15 * exact, forcing=F, damping=D, gap=gap)
    graph = cv.diagram(start, over="frequency", within=(0.95 * exact, 1.3 * exact), depth=0)
    assert max(values(graph, "switch-graze")) == pytest.approx(exact, abs=1e-10)
