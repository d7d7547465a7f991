"""Drawn branches in closed form with clusters of folds, doublings and pairs; ``python -m tools.fuzz.spectra 1000`` asks for more."""

import numpy as np
import pytest

import contvines as cv
from tests.contvines.lines import Line
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


class Bordered(Spectrum):
    """One whose branch ends within its cluster, at a place in units of the cluster's size."""

    n_margins = 1

    def __init__(self, seed, edge):
        super().__init__(seed)
        self.edge = self.size * edge

    @staticmethod
    def _inspect(data, u, p, work, row):
        Spectrum._inspect(data, u, p, work, row)
        row[4] = data.edge - u[0]

    def margin_kind(self, j):
        return "velocity-graze"

    def places(self):
        return [place for place in super().places() if place.u < self.edge]


@pytest.mark.parametrize(("seed", "edge"), [(278, 0.6043194360076303), (304, 2.770818128156563)])
def test_as_many_folds_as_the_direction_changes_before_a_border(seed, edge):
    # the parameter turns by less than rounding between the second fold and the border
    said, _ = Bordered(seed, edge).wrong()
    assert not said


@pytest.mark.parametrize("place", [-8e-7, -3e-7, -1.5e-7, -5e-8])
def test_a_doubling_close_before_a_border(place):
    """Between the border and the place close before it from which one-sided limits are taken."""

    def multipliers(u, p):
        product = 0.5 * np.tanh((u - place) / 0.5)
        return np.roots([1.0, 1.0 - product, product])  # one is -1 where the product is 0

    problem = Line(lambda u, p: [-u], multipliers, start=(-0.7, -0.7))
    graph = cv.diagram(problem, within=(-1.7, 1.9), depth=0)
    (doubling,) = graph.of_kind("period-doubling")
    assert doubling.u[0] == pytest.approx(place, abs=1e-12)
    assert not graph.unresolved


def test_a_pair_is_found_where_another_multiplier_is_near_the_circle_at_the_point_beside_it():
    """1.4e-5 inside it at the period doubling: certainly inside, so that a pair has left the circle before the fold."""
    said, _ = Spectrum(101415).wrong()
    assert not said
