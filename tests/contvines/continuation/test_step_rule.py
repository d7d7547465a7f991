"""The step rule as an object that a user may replace, and what the corrector makes of a tolerance."""

import numpy as np
import pytest

import contvines as cv
from contvines.continuation.engine import Engine
from contvines.continuation.settings import Settings
from contvines.continuation.starts import solve_start
from contvines.continuation.trace import chunks
from contvines.core.library import native
from contvines.problems.protocol import Kernels, ProblemDefaults
from tests.contvines.compiled import Made, in_memory


def linearise(wrong, u, p, work):
    """u - p = 0, with a slope that is wrong by a share."""
    work[0], work[1] = u[0] - p, 1.0 + wrong[0]
    return abs(work[0])


def bordered(wrong, work, border, n, step, tangent):
    F, slope = work
    det = slope * border[1] + border[0]
    step[0] = (-F * border[1] + n) / det
    step[1] = (slope * n + F * border[0]) / det
    tangent[0], tangent[1] = 1.0 / det, slope / det
    return 1.0 if det > 0.0 else -1.0


def inspect(wrong, u, p, work, row):
    row[0], row[1] = 0.0, 0.0


class Line(ProblemDefaults):
    dimension, n_multipliers, spectrum, parameter = 1, 1, "map", "p"

    def __init__(self, kernels, wrong=0.0):
        self.kernels = kernels
        self.data = in_memory(wrong) if kernels.compiled else [wrong]

    def workspace(self):
        return in_memory(0.0, 0.0) if self.kernels.compiled else np.zeros(2)


INTERPRETED = Kernels(linearise, bordered, inspect)
KERNELS = {"interpreted": INTERPRETED}
if native():
    KERNELS["compiled"] = Made(linearise, bordered, inspect, (1, 1, 2, 2))
each = pytest.mark.parametrize("kernels", KERNELS.values(), ids=KERNELS)


def constant(turn, error, sweeps, length, angle, roundoff):
    return 1.0


def picky(turn, error, sweeps, length, angle, roundoff):
    """Nothing above a hundredth; below it three quarters of the step before."""
    return -0.5 if length > 0.01 else 0.75


def points(kernels, rule, **settings):
    engine = Engine(Line(kernels), (0.0, 1.0), Settings(step_rule=rule, **settings))
    return np.concatenate([c.values[:-1] for c in chunks(engine, solve_start(engine, [0.0], 0.0))])


@each
def test_a_rule_of_ones_own_is_asked(kernels):
    steps = np.diff(points(kernels, cv.StepRule(constant, "constant"), first_step=0.02, max_step=0.5))
    assert steps == pytest.approx(steps[0], rel=1e-9)  # the line is straight: equal lengths, equal steps
    assert steps[0] == pytest.approx(0.02 / np.sqrt(2.0), rel=1e-9)  # <(1, 1), (1, 1)> = 2


@each
def test_an_error_in_a_rule_is_raised(kernels):
    def broken(*numbers):
        raise ZeroDivisionError("of the rule")

    with pytest.raises(ZeroDivisionError, match="of the rule"):
        points(kernels, cv.StepRule(broken, "broken"))


def test_a_negative_factor_rejects_the_step_and_shortens_it():
    steps = np.diff(
        points(INTERPRETED, cv.StepRule(picky, "picky"), first_step=0.03, max_step=0.5, min_step=1e-5)
    )
    assert steps[:3] * np.sqrt(2.0) == pytest.approx([0.0075, 0.0075 * 0.75, 0.0075 * 0.75**2], rel=1e-9)


@pytest.mark.parametrize("tolerance", [1e-6, 1e-10, 1e-13])
def test_the_tolerance_bounds_the_last_correction(tolerance):
    """With a slope that is a tenth too steep each correction is about an eleventh of the one before."""
    engine = Engine(
        Line(INTERPRETED, wrong=0.1), (0.0, 1.0), Settings(tolerance=tolerance, max_iterations=30)
    )
    start = solve_start(engine, [0.0], 0.0)
    corrections = np.concatenate([c.corrections[1:] for c in chunks(engine, start)])
    assert len(corrections) > 5 and corrections.max() <= tolerance
