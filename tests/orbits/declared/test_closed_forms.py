"""Declared machines against closed forms, each derived in its docstring."""

import math

import mpmath as mp
import numpy as np
import pytest

import contvines as cv
from tools.pages.pages import page


def specials(graph, kind):
    return sorted(point.value for point in graph.special.values() if point.kind == kind)


def single_impact(frequency, restitution, gap):
    """(phase, speed after the impact, multipliers' trace) of x'' + x = cos(W t) with one impact per period.

    x = A cos t + B sin t + g cos(W t + f), g = 1/(1 - W^2), from x(0) = x(T) = gap and x'(0) = -e x'(T):
    A = gap - g cos f, B = A tan(T/2), and g W sin f = A tan(T/2) (1 - e)/(1 + e).
    """
    W, e = mp.mpf(frequency), mp.mpf(restitution)
    T, g, R = 2 * mp.pi / W, 1 / (1 - W**2), (1 - e) / (1 + e)
    t = mp.tan(T / 2)
    # g W sin f + g t R cos f = gap t R
    size, angle = mp.hypot(g * W, g * t * R), mp.atan2(g * t * R, g * W)
    base = mp.asin(gap * t * R / size)
    found = []
    for root in (base, mp.pi - base):
        f = root - angle
        A = gap - g * mp.cos(f)
        v = A * t - g * W * mp.sin(f)
        if v < 0:
            found.append((f, v))

    def trace(f, v):
        def x(s, phase, speed):
            A = gap - g * mp.cos(phase)
            B = speed + g * W * mp.sin(phase)
            return A * mp.cos(s) + B * mp.sin(s) + g * mp.cos(W * s + phase)

        def rate(s, phase, speed):
            A = gap - g * mp.cos(phase)
            B = speed + g * W * mp.sin(phase)
            return -A * mp.sin(s) + B * mp.cos(s) - g * W * mp.sin(W * s + phase)

        dT = [-mp.diff(x, (T, f, v), n) / rate(T, f, v) for n in ((0, 1, 0), (0, 0, 1))]
        acceleration = mp.diff(rate, (T, f, v), (1, 0, 0))
        here = 1 + W * dT[0]
        there = -e * (mp.diff(rate, (T, f, v), (0, 0, 1)) + acceleration * dT[1])
        return here + there

    return [(f, v, trace(f, v)) for f, v in found]


def test_single_impact_orbits_and_their_multipliers():
    machine = page("impact_oscillator")
    with mp.workdps(30):
        ((f, v, trace),) = single_impact(2.3, 0.8, 0)
    orbit = machine.attractor(frequency=2.3).orbit
    assert orbit.word.text == "R" and orbit.real and orbit.stable
    assert math.cos(orbit.nodes[0, 0] - float(f)) == pytest.approx(1.0, abs=1e-14)
    assert orbit.nodes[0, 2] == pytest.approx(float(v), abs=1e-12)
    assert orbit.multipliers.sum().real == pytest.approx(float(trace), abs=1e-11)
    assert np.prod(orbit.multipliers).real == pytest.approx(0.64, abs=1e-12)  # e^2: nothing else dissipates


def test_period_doubling_of_the_impact_oscillator():
    """A multiplier -1: 1 + trace + e^2 = 0."""
    machine = page("impact_oscillator")
    with mp.workdps(30):
        exact = mp.findroot(
            lambda W: 1 + single_impact(W, mp.mpf("0.8"), 0)[0][2] + mp.mpf("0.64"), (2.6, 2.7)
        )
    graph = cv.diagram(machine.attractor(frequency=2.3), over="frequency", within=(2.2, 2.7), depth=0)
    assert specials(graph, "period-doubling") == pytest.approx([float(exact)], abs=1e-10)


def test_fold_of_the_impact_oscillator_with_a_gap():
    """Two single-impact orbits meet where g^2 (W^2 + t^2 R^2) = (gap t R)^2 (see `single_impact`)."""
    machine = page("impact_oscillator")
    W, e = 1.6, 0.8  # tan(T/2) < 0: the impact moves away from a wall at a positive distance
    g, t, R = 1 / (1 - W**2), math.tan(math.pi / W), (1 - e) / (1 + e)
    exact = abs(g) * math.hypot(W, t * R) / abs(t * R)
    with mp.workdps(20):
        branches = single_impact(W, mp.mpf(e), mp.mpf(0.9 * exact))
    assert branches
    f, v, _ = branches[0]
    orbit = machine.orbit("R", 1, [[float(f), 0.9 * exact, float(v)]], frequency=W, gap=0.9 * exact)
    graph = cv.diagram(orbit, over="gap", within=(0.5 * exact, 1.5 * exact), depth=0)
    assert specials(graph, "fold") == pytest.approx([exact], abs=1e-10)


@pytest.mark.parametrize(
    ("n", "g", "e", "W"), [(1, 0.1, 0.8, 1.0), (2, 0.07, 0.63, 1.3), (3, 0.05, 0.7, 0.8)]
)
def test_fold_and_flip_of_the_bouncing_ball(n, g, e, W):
    """Once in n periods the ball leaves with g T/2 and lands with -g T/2, so the table moves with w = (1 - e)/(1 + e) g T/2 there.

    Fold: A W = w. Flip: A W^2 cos f = 2 g (1 + e^2)/(1 + e)^2 with A W sin f = -w still.
    """
    machine = page("bouncing_ball")
    speed = g * math.pi * n / W
    needed = (1 - e) / (1 + e) * speed / W
    flip = math.hypot(needed, 2 * g * (1 + e**2) / (1 + e) ** 2 / W**2)
    amplitude = 0.5 * (needed + flip)
    phase = -math.asin(needed / amplitude)
    guess = [[phase, amplitude * math.cos(phase), speed]]
    numbers = {"amplitude": amplitude, "gravity": g, "restitution": e, "frequency": W}
    orbit = machine.orbit("B", n, guess, **numbers)
    assert orbit.stable
    graph = cv.diagram(orbit, over="amplitude", within=(0.5 * needed, 1.5 * flip), depth=0)
    assert specials(graph, "fold") == pytest.approx([needed], abs=1e-10)
    assert specials(graph, "period-doubling") == pytest.approx([flip], abs=1e-10)


@pytest.mark.parametrize(("W", "f"), [(0.8, 0.3), (0.62, 0.45)])
def test_den_hartogs_onset_of_sticking(W, f):
    """Turns at +-x0 half a period apart: x0^2 = (F/(1 - W^2))^2 - (f S/(W (1 + C)))^2, C, S = cos, sin(pi/W).

    At a turn the shaking beats friction while x0 W^2 > f.
    """
    machine = page("den_hartog")
    C, S = math.cos(math.pi / W), math.sin(math.pi / W)
    exact = abs(1 - W**2) * math.hypot(f / W**2, f * S / (W * (1 + C)))
    start = machine.attractor(frequency=W, friction=f)
    x0 = math.sqrt((1 / (1 - W**2)) ** 2 - (f * S / (W * (1 + C))) ** 2)
    assert np.abs(start.orbit.nodes[:, 1]).max() == pytest.approx(x0, abs=1e-11)
    graph = cv.diagram(start, over="forcing", within=(0.35, 1.1), depth=0)
    assert min(specials(graph, "stick"), key=lambda v: abs(v - exact)) == pytest.approx(exact, abs=1e-10)
    assert graph["B1"].description["word"] == "tt"


@pytest.mark.parametrize(("F", "D", "gap"), [(0.5, 0.05, 1.0), (0.3, 0.02, 1.4), (0.8, 0.12, 0.9)])
def test_grazing_of_the_elastic_stop(F, D, gap):
    """The linear motion touches the stop where its amplitude F/|1 - W^2 + 2 i D W| is the gap."""
    machine = page("elastic_stop")
    square = np.roots([1.0, 4 * D**2 - 2.0, 1.0 - (F / gap) ** 2])
    exact = math.sqrt(square.max())
    start = machine.attractor(frequency=1.15 * exact, forcing=F, damping=D, gap=gap)
    graph = cv.diagram(start, over="frequency", within=(0.95 * exact, 1.3 * exact), depth=0)
    assert specials(graph, "switch-graze")[-1] == pytest.approx(exact, abs=1e-10)
