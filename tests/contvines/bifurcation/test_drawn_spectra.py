"""Drawn branches in closed form with clusters of folds, doublings and pairs; ``python -m tools.fuzz.spectra 1000`` asks for more."""

import pytest

from tools.fuzz.spectra import Spectrum


@pytest.mark.parametrize("first", range(0, 100, 20))
def test_nothing_is_lacking_without_a_word(first):
    for seed in range(first, first + 20):
        said, _ = Spectrum(seed).wrong()
        assert not said


def test_two_multipliers_that_meet_beside_the_circle_are_no_doubling():
    # they leave the axis at -1.0037, a thousandth of the cluster's size from where one of them is -1
    graph = Spectrum(174).graph()
    (doubling,) = graph.of_kind("period-doubling")
    assert abs(doubling.multipliers + 1.0).min() < 1e-12


@pytest.mark.parametrize("seed", [139, 197, 227])
def test_folds_between_which_the_parameter_changes_by_less_than_rounding_are_one_at_least(seed):
    # a multiplier passes +1 where the branch stands upright and is alone: no step to another branch
    assert Spectrum(seed).graph().of_kind("fold")


def test_as_many_folds_as_the_direction_changes():
    # three of them, the middle one between places at which the parameter's part of the tangent is below rounding
    problem = Spectrum(1728)
    folds = sorted(fold.u[0] for fold in problem.graph().of_kind("fold"))
    assert folds == pytest.approx(list(problem.folds), abs=1e-6 * problem.size)
