"""The step rule as an object that a user may replace, and what the corrector makes of a tolerance."""

import numpy as np
import pytest

import contvines as cv
from tests.contvines.continuation.curves import INTERPRETED, each, line


def constant(turn, error, sweeps, length, angle, roundoff):
    return 1.0


def picky(turn, error, sweeps, length, angle, roundoff):
    """Nothing above a hundredth; below it three quarters of the step before."""
    return -0.5 if length > 0.01 else 0.75


def steps(kernels, rule, **settings):
    parts = line(kernels).chunks((0.0, 1.0), step_rule=cv.StepRule(rule, "own"), **settings)
    return np.diff(np.concatenate([c.values[:-1] for c in parts]))


@each
def test_a_rule_of_ones_own_is_asked(kernels):
    # the line is straight: equal lengths, equal steps; <(1, 1), (1, 1)> = 2
    found = steps(kernels, constant, first_step=0.02, max_step=0.5)
    assert found == pytest.approx(0.02 / np.sqrt(2.0), rel=1e-9)


@each
def test_an_error_in_a_rule_is_raised(kernels):
    def broken(*numbers):
        raise ZeroDivisionError("of the rule")

    with pytest.raises(ZeroDivisionError, match="of the rule"):
        steps(kernels, broken)


def test_a_negative_factor_rejects_the_step_and_shortens_it():
    found = steps(INTERPRETED, picky, first_step=0.03, max_step=0.5, min_step=1e-5)
    assert found[:3] * np.sqrt(2.0) == pytest.approx([0.0075, 0.0075 * 0.75, 0.0075 * 0.75**2], rel=1e-9)


@pytest.mark.parametrize("tolerance", [1e-6, 1e-10, 1e-13])
def test_the_tolerance_bounds_the_last_correction(tolerance):
    """With a slope that is a tenth too steep each correction is about an eleventh of the one before."""
    parts = line(INTERPRETED, wrong=0.1).chunks((0.0, 1.0), tolerance=tolerance, max_iterations=30)
    corrections = np.concatenate([c.corrections[1:] for c in parts])
    assert len(corrections) > 5 and corrections.max() <= tolerance
