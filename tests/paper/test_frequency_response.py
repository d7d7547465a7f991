"""The exact frequency response at G = 2.47, its special points solved once more in eighty digits.

Machine: r = 0.76, mu = 0.5, g = 0.211, eps = 0.006, damping 1. The values below are those of an integration of the equations of motion
(scipy's DOP853 over flights of given length, Newton's method with differences of fourth order), to 2e-11.
"""

import mpmath as mp
import numpy as np
import pytest
from scipy.optimize import brentq

import contvines as cv
from tests.machines import COUPLED
from tools.fuzz.many_digits import Motion, exact

pytestmark = pytest.mark.slow

FOLDS = (0.9717226436161, 1.0280413226418)
BREAKINGS = (0.9856523298452, 1.0037775486975)
NEIMARK_SACKER = (1.0254097153168, 1.0280328051003)  # on the fast and on the slow side of the fold
VELOCITY_GRAZES = (0.9939465060952, 0.9986022947078)
WALL_GRAZES = (0.9934295505152, 1.0063834057387)


@pytest.fixture(scope="module")
def graph():
    orbit = COUPLED.orbit("LR", frequency=1.01)
    return cv.diagram(orbit, over="frequency", within=(0.94, 1.07), depth=0, virtual=True)


@pytest.fixture(scope="module")
def pieces(graph):
    """The symmetric motions LR: real and virtual branches, from below to above."""
    found = [b for b in graph if b.description["word"] == "LR" and b.description["symmetric"]]
    return [
        sorted((b for b in found if b.real == kind), key=lambda branch: branch.range)
        for kind in (True, False)
    ]


def points_of(graph, pieces, kind):
    labels = {branch.label for both in pieces for branch in both}
    return sorted((p for p in graph.of_kind(kind) if p.branch in labels), key=lambda point: point.value)


def test_the_symmetric_response_from_graze_to_graze(graph, pieces):
    """Real from graze to graze, virtual in between; folds, breakings, Neimark-Sacker points and borders as integrated."""
    (below, above), virtual = pieces
    assert below.range == pytest.approx((FOLDS[0], VELOCITY_GRAZES[0]), abs=1e-11)
    assert above.range == pytest.approx((VELOCITY_GRAZES[1], FOLDS[1]), abs=1e-11)
    for branch, ends in zip((below, above), zip(VELOCITY_GRAZES, WALL_GRAZES)):
        assert sorted(branch.values[[0, -1]]) == pytest.approx(sorted(ends), abs=1e-11)
    assert [branch.range for branch in virtual] == [
        pytest.approx(WALL_GRAZES, abs=1e-11),
        pytest.approx(VELOCITY_GRAZES, abs=1e-11),
    ]
    for kind, values, error in (
        ("fold", FOLDS, 1e-11),
        ("symmetry-breaking", BREAKINGS, 1e-11),
        ("neimark-sacker", NEIMARK_SACKER, 1e-10),
    ):
        assert [p.value for p in points_of(graph, pieces, kind)] == pytest.approx(values, abs=error)
    assert below.stable_intervals() == [pytest.approx((FOLDS[0], BREAKINGS[0]), abs=1e-11)]
    assert above.stable_intervals() == [pytest.approx((BREAKINGS[1], NEIMARK_SACKER[0]), abs=1e-10)]
    for point in graph.special.values():
        if point.kind in ("velocity-graze", "wall-graze", "stick") and point.branch in (
            below.label,
            above.label,
        ):
            assert point.replay < 1e-6


@pytest.mark.parametrize("kind", ["fold", "symmetry-breaking", "neimark-sacker"])
def test_multipliers_in_eighty_digits(graph, pieces, kind):
    for point in points_of(graph, pieces, kind):
        there = exact(point.orbit)
        assert abs(there.shift) < 1e-12 and there.moved < 1e-9
        if kind == "neimark-sacker":
            pair = there.multipliers[np.abs(there.multipliers.imag) > 1e-3]
            assert np.abs(np.abs(pair) - 1.0).min() < 1e-9
        else:
            assert np.abs(there.multipliers - 1.0).min() < 1e-7


def test_velocity_grazes_in_eighty_digits(graph, pieces):
    """There w' and w'' vanish together inside the flight of the symmetric orbit."""
    found = points_of(graph, pieces, "velocity-graze")
    assert len(found) >= 2
    for point in found:
        there, motion = exact(point.orbit), Motion(point.orbit)
        with mp.workdps(80):
            machine = motion.machine(there.value)
            begin = machine.state(motion.codes[0], there.nodes[0])

            def rate(t):
                _, _, cavity, _, absorber = machine.flow(motion.modes[0], begin, t)  # noqa: B023
                return motion.modes[0] * (cavity - absorber)  # noqa: B023

            least = min(np.linspace(0.3, 2.8, 51), key=lambda t: abs(rate(mp.mpf(t))))
            at = mp.findroot(lambda t: mp.diff(rate, t), least)
            assert 0.3 < at < 2.8 and abs(rate(at)) < 1e-9


def test_the_sliding_motion_reaches_the_walls_where_impacts_end(graph, pieces):
    for value in WALL_GRAZES:
        positions = COUPLED.sliding_orbit(frequency=value).nodes[:, 1]
        assert np.abs(positions) == pytest.approx(1.0, abs=1e-9)


def test_the_linear_regime_leads_to_all_others():
    """From the absorber stuck below resonance, by borders alone: stick-slip, sliding, impacts, and the linear regime above."""

    def left_over(omega):  # friction that the linear response with the mass 1 + eps does not need
        drag = 1j * 0.006 * omega
        response = 0.006 * 2.47 * abs(1.0 + drag) / abs(1.0 - 1.006 * omega**2 + drag)
        return 0.5 * 0.211 - omega**2 * response

    slips = brentq(left_over, 0.9, 0.97, xtol=1e-15), brentq(left_over, 1.03, 1.1, xtol=1e-15)
    graph = cv.diagram(COUPLED.orbit("", frequency=0.93), over="frequency", within=(0.92, 1.09), depth=2)
    stuck = [branch for branch in graph if branch.description["word"] == ""]
    assert sorted(branch.range for branch in stuck) == [
        pytest.approx((0.92, slips[0]), abs=1e-11),
        pytest.approx((slips[1], 1.09), abs=1e-11),
    ]
    words = {branch.description["word"] for branch in graph if branch.real and branch.stable.any()}
    assert {"", "ss", "tt"} <= words and words & {"LR", "RL"}
    assert min(p.value for p in graph.of_kind("fold")) == pytest.approx(FOLDS[0], abs=1e-11)
