"""Ctrl-C during long work from Python: what is done is in the hands of whoever called, and can be gone on with."""

import signal

import numpy as np
import pytest

import contvines as cv
from contvines.graph.persistence import same_graph
from contvines.survey import survey
from orbits import Absorber


class Interrupting:
    """Progress that presses Ctrl-C when it is told something for the nth time."""

    def __init__(self, at):
        self.at, self.count = at, 0

    def __call__(self, state):
        self.count += 1
        if self.count == self.at:
            signal.raise_signal(signal.SIGINT)


def henon(x, p):
    return [1.0 - p.a * x[0] ** 2 + x[1], 0.3 * x[0]]


def start():
    return cv.MapProblem(henon, [0.6, 0.2], {"a": 0.2}, parameter="a")


@pytest.fixture(scope="module")
def whole():
    return cv.diagram(start(), within=(0.0, 1.0), depth=2)


@pytest.mark.parametrize("at", [1, 2, 4])
def test_a_diagram_goes_on_to_the_undisturbed_graph(whole, at):
    with pytest.raises(KeyboardInterrupt) as stopped:
        cv.diagram(start(), within=(0.0, 1.0), depth=2, progress=Interrupting(at))
    assert isinstance(stopped.value, cv.Interrupted)
    graph = stopped.value.graph
    assert isinstance(graph, cv.Graph) and not graph.finished
    ended = cv.resume(graph)
    assert ended.finished and same_graph(ended, whole)


def test_it_may_be_returned_instead(whole):
    graph = cv.diagram(start(), within=(0.0, 1.0), depth=2, progress=Interrupting(2), interrupt="return")
    assert not graph.finished
    assert same_graph(cv.resume(graph), whole)


def test_an_atlas(whole):
    options = {"over": "a", "within": (0.0, 1.0), "values": 4, "starts": 8, "scan": 2}
    with pytest.raises(cv.Interrupted) as stopped:
        cv.atlas(start(), progress=Interrupting(3), **options)
    assert same_graph(cv.resume(stopped.value.graph), cv.atlas(start(), **options))


def linear(u, p):
    """A fold at a = b, so the locus is a straight line."""
    return [u[0] ** 2 - p.a + p.b]


def test_a_chart_keeps_its_loci():
    graph = cv.diagram(
        cv.AlgebraicProblem(linear, [1.0], {"a": 1.0, "b": 0.0}, parameter="a"), within=(-0.5, 1.5)
    )
    options = {"over": "b", "within": (-0.4, 0.4)}
    with pytest.raises(cv.Interrupted) as stopped:
        cv.chart(graph, progress=Interrupting(2), **options)
    chart = stopped.value.graph
    assert isinstance(chart, cv.Chart) and not chart.finished
    ended = cv.resume(chart)
    assert ended.finished
    values = next(iter(ended.loci.values())).values
    np.testing.assert_allclose(values[:, 0], values[:, 1], atol=1e-9)


def family(values, near):
    return Absorber(restitution=values["restitution"], friction=0.5, gravity=0.211).symmetric_orbit(
        amplitude=0.6
    )


def test_a_survey_keeps_its_rows():
    options = {"over": "amplitude", "within": (0.5, 0.7), "depth": 0, "workers": 1, "gaps": 0}
    vary = {"restitution": [0.6, 0.7, 0.8]}
    with pytest.raises(cv.Interrupted) as stopped:
        survey(family, vary, progress=Interrupting(2), **options)
    found = stopped.value.graph
    assert [note.startswith("not done yet") for note in found.notes] == [False, False, True]
    rest, undisturbed = cv.resume(found), survey(family, vary, **options)
    np.testing.assert_array_equal(rest["peak"], undisturbed["peak"])


def test_bad_words_and_finished_graphs_are_refused(whole):
    with pytest.raises(ValueError, match="interrupt = 'stop'"):
        cv.diagram(start(), within=(0.0, 1.0), interrupt="stop")
    with pytest.raises(ValueError, match="nothing to go on with"):
        cv.resume(whole)
