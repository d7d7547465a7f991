"""The step rule as an object that a user may replace."""

import numpy as np
import pytest

import contvines as cv
from tests.machines import ABSORBER

LINE = cv.AlgebraicProblem(lambda u, p: u - p, [0.0], 0.0, scale=1.0)


def constant(turn, error, sweeps, length, angle, roundoff):
    return 1.0


def picky(turn, error, sweeps, length, angle, roundoff):
    """Nothing above a hundredth; below it three quarters of the step before."""
    return -0.5 if length > 0.01 else 0.75


def broken(*numbers):
    raise ZeroDivisionError("of the rule")


def steps(seed, over, rule, **settings):
    settings["step_rule"] = cv.StepRule(rule, "own")
    points = cv.trace(seed, within=(0.0, 1.0), over=over, settings=settings)
    return np.diff([point.value for point in points])


def test_a_rule_of_ones_own_is_asked():
    # the line is straight: equal lengths, equal steps; <(1, 1), (1, 1)> = 2
    found = steps(LINE, "p", constant, first_step=0.02, max_step=0.5)[:-1]
    assert found == pytest.approx(0.02 / np.sqrt(2.0), rel=1e-9)


def test_a_negative_factor_rejects_the_step_and_shortens_it():
    found = steps(LINE, "p", picky, first_step=0.03, max_step=0.5, min_step=1e-5)
    assert found[:3] * np.sqrt(2.0) == pytest.approx([0.0075, 0.0075 * 0.75, 0.0075 * 0.75**2], rel=1e-9)


@pytest.mark.parametrize(
    ("seed", "over"), [(LINE, "p"), (ABSORBER.symmetric_orbit(amplitude=0.6), "amplitude")]
)
def test_an_error_in_a_rule_is_raised(seed, over):
    with pytest.raises(ZeroDivisionError, match="of the rule"):
        steps(seed, over, broken)
