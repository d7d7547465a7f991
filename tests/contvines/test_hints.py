"""What is nearly right is refused with a hint."""

import numpy as np
import pytest

import contvines as cv


def line():
    return cv.AlgebraicProblem(lambda u, p: u - p, [0.0])


def test_a_misspelt_argument_has_a_hint():
    with pytest.raises(
        TypeError, match=r"diagram has no argument 'dept' \(did you mean 'depth'\?\); it has seed, over"
    ):
        cv.diagram(line(), within=(-1.0, 1.0), dept=3)
    with pytest.raises(TypeError, match=r"settings=\{'max_step': 0.01\} would do"):
        cv.diagram(line(), within=(-1.0, 1.0), max_step=0.01)
    with pytest.raises(TypeError, match=r"trace has no argument 'whithin' \(did you mean 'within'"):
        cv.trace(line(), whithin=(-1.0, 1.0))
    with pytest.raises(TypeError, match=r"switch has no argument 'deph'"):
        cv.switch(cv.diagram(line(), within=(-1.0, 1.0)), "EP1", deph=1)


def test_kinds_that_there_are_not():
    graph = cv.diagram(line(), within=(-1.0, 1.0))
    assert len(graph.of_kind("end")) == 2 and graph.of_kind("symmetry-breaking") == []
    with pytest.raises(ValueError, match=r"there is no kind 'SB' \(did you mean 'symmetry-breaking'\?\)"):
        graph.of_kind("SB")
    with pytest.raises(ValueError, match=r"there is no kind 'folds' \(did you mean 'fold'\?\)"):
        graph.of_kind("folds")


def test_points_that_there_are_not():
    branch = cv.diagram(line(), within=(-1.0, 1.0))["B1"]
    with pytest.raises(
        IndexError, match=rf"B1 has no point 1000; its {len(branch)} points are numbered from 0"
    ):
        branch.orbit(1000)
    assert np.array_equal(branch.orbit(-1).u, branch.points[-1])


def test_other_functions_have_hints_too():
    graph = cv.diagram(line(), within=(-1.0, 1.0))
    with pytest.raises(TypeError, match=r"atlas has no argument 'valus' \(did you mean 'values'\?\)"):
        cv.atlas(line(), valus=3)
    with pytest.raises(TypeError, match=r"plot_diagram has no argument 'colour' \(did you mean 'color'\?\)"):
        graph.plot(colour="word")
    with pytest.raises(TypeError, match=r"B1.orbit\(1.5\): give the number of a point, from 0"):
        graph["B1"].orbit(1.5)


def test_short_forms_are_one_line_and_tell_the_truth():
    graph = cv.diagram(line(), within=(-1.0, 1.0))
    assert repr(graph["EP1"]) == "SpecialPoint(EP1: end on B1 at p = -1)"
    for thing in (graph, graph["B1"], graph["EP1"]):
        assert "\n" not in repr(thing) and len(repr(thing)) < 140
        assert "<table" in thing._repr_html_()


def test_a_misspelt_parameter_of_a_machine_has_a_hint():
    from orbits import Absorber, Coupled

    with pytest.raises(TypeError, match=r"Absorber has no parameter 'frction' \(did you mean 'friction'\?\)"):
        Absorber(restitution=0.76, frction=0.5, gravity=0.211)
    with pytest.raises(TypeError, match=r"Coupled has no parameter 'forcng' \(did you mean 'forcing'\?\)"):
        Coupled(forcng=2.0)
