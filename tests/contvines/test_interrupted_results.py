"""Ctrl-C during long work from Python: what is done is in the hands of whoever called, and can be gone on with."""

import signal

import numpy as np
import pytest

import contvines as cv
from contvines.graph.persistence import same_graph
from contvines.survey import survey
from orbits import Absorber
from tests.contvines.loci.systems import henon_of


class Interrupting:
    """Progress that presses Ctrl-C when it is told something for the nth time."""

    def __init__(self, at):
        self.at, self.count = at, 0

    def __call__(self, state):
        self.count += 1
        if self.count == self.at:
            signal.raise_signal(signal.SIGINT)


def henon():
    return cv.MapProblem(henon_of, [0.6, 0.2], 0.2, parameter="a")


def diagram(**options):
    return cv.diagram(henon(), within=(0.0, 1.0), depth=2, **options)


def atlas(**options):
    return cv.atlas(henon(), over="a", within=(0.0, 1.0), values=4, starts=8, scan=2, **options)


def chart(**options):
    """A fold at a = b, so the locus is a straight line."""
    line = cv.AlgebraicProblem(
        lambda u, p: [u[0] ** 2 - p.a + p.b], [1.0], {"a": 1.0, "b": 0.0}, parameter="a"
    )
    return cv.chart(cv.diagram(line, within=(-0.5, 1.5)), over="b", within=(-0.4, 0.4), **options)


def family(values, near):
    return Absorber(**values, friction=0.5, gravity=0.211).symmetric_orbit(amplitude=0.6)


def surveyed(**options):
    asked = {"over": "amplitude", "within": (0.5, 0.7), "depth": 0, "workers": 1, "gaps": 0}
    return survey(family, {"restitution": [0.6, 0.7, 0.8]}, **asked, **options)


@pytest.mark.parametrize(
    ("work", "at"), [(diagram, 1), (diagram, 2), (diagram, 4), (atlas, 3), (chart, 2), (surveyed, 2)]
)
def test_interrupted_work_goes_on_to_the_undisturbed_result(work, at):
    with pytest.raises(KeyboardInterrupt) as stopped:
        work(progress=Interrupting(at))
    assert isinstance(stopped.value, cv.Interrupted)
    left, whole = stopped.value.graph, work()
    assert isinstance(left, type(whole))
    if work is surveyed:
        assert [note.startswith("not done yet") for note in left.notes] == [False, False, True]
        np.testing.assert_array_equal(cv.resume(left)["peak"], whole["peak"])
        return
    assert not left.finished
    ended = cv.resume(left)
    assert ended.finished
    if work is chart:
        (locus,) = ended.loci.values()
        np.testing.assert_allclose(locus.values[:, 0], locus.values[:, 1], atol=1e-9)
    else:
        assert same_graph(ended, whole)


def test_it_may_be_returned_instead():
    graph = diagram(progress=Interrupting(2), interrupt="return")
    assert not graph.finished
    assert same_graph(cv.resume(graph), diagram())
