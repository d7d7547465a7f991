"""Outcomes of made-up diagrams, by hand."""

from types import SimpleNamespace

import numpy as np
import pytest

import contvines as cv
from contvines.graph.stretches import highest, inside, stretches
from contvines.survey import outcomes


class Made(SimpleNamespace):
    """A branch whose stable motions have these heights."""

    problem, measure_names, default_measure = None, ("norm",), ""

    def __len__(self):
        return len(self.values)

    def measure(self, name):
        return self.heights

    def pieces(self):
        return [(0, len(self) - 1, True)]

    def stable_intervals(self):
        return [(self.values.min(), self.values.max())]


def branch(word, values, heights, real=True):
    description = {"word": word, "impacts": word.count("L")}
    return Made(values=values, heights=heights + 0.0 * values, description=description, real=real)


@pytest.fixture
def found(monkeypatch):
    """A low response `tt` from 0 to 0.6, a high one `LR` from 0.4 to 1, a virtual one, two overlapping stretches of `LRs`."""
    monkeypatch.setattr("contvines.graph.stretches.default_measure", lambda graph: "height")
    p = np.linspace(0.0, 1.0, 101)
    parts = [
        branch("tt", p[:61], 1.0 + p[:61]),
        branch("LR", p[40:], 3.0 - p[40:]),
        branch("LR", p, 9.0, real=False),
        branch("LRs", p[70:81], 0.1),
        branch("LRs", p[75:91], 0.1),
    ]
    folds = [SimpleNamespace(value=0.2, real=False), SimpleNamespace(value=0.7, real=True)]
    branches = {f"B{i}": part for i, part in enumerate(parts)}
    graph = SimpleNamespace(within=(0.0, 1.0), branches=branches, attractors=(), of_kind={"fold": folds}.get)
    return outcomes.Findings(graph, None)


def test_peaks(found):
    assert outcomes.peak(found) == pytest.approx({"peak": 2.6, "peak_at": 0.4})
    lower = outcomes.lower_peak(found)  # tt up to 0.6, then LR until LRs is lower still
    assert lower == pytest.approx({"lower_peak": 2.4, "lower_peak_at": 0.6}, abs=0.01)


def test_a_largest_response_at_the_end_is_looked_at_from_inside():
    """u' = p^2 - u: the stable solution u = p^2 is largest at the end, p = 1, and a fifth lower near p = 0.9."""
    graph = cv.diagram(
        cv.FlowProblem(lambda x, q: [q.p**2 - x[0]], [0.25], {"p": 0.5}), over="p", within=(0.0, 1.0)
    )
    top = highest(stretches(graph))
    assert top is not None and top[:2] == pytest.approx((1.0, 1.0))
    u, p, response = inside(top, 0.19)
    assert u[0] == pytest.approx(p**2, rel=1e-9) and response == pytest.approx(p**2, rel=1e-9)
    assert response == pytest.approx(0.81, rel=0.03)


def test_ranges(found):
    assert outcomes.covered(found)["covered"] == pytest.approx(1.0)
    assert outcomes.stable_range(found, "LRs") == pytest.approx(
        {"stable_LRs": 0.2, "stable_LRs_from": 0.7, "stable_LRs_to": 0.9}
    )
    assert outcomes.first_point(found, "fold") == {"first_fold": 0.7}
    # two from 0.4 to 0.6 and from 0.7 to 0.9, three where both of `LRs` overlap
    assert outcomes.coexisting(found) == pytest.approx({"coexisting": 3, "ambiguous": 0.4}, abs=0.01)
    assert np.isnan(outcomes.share(found, "LR")["share_LR"])
    simulated = [(1.0, {}, "LR"), (1.0, {}, "tt")]
    assert outcomes.share(outcomes.Findings(found.graph, None, simulated), "LR") == {"share_LR": 0.5}
    del found.graph.branches["B0"]
    assert outcomes.covered(found)["covered"] == pytest.approx(0.6)


def test_activation_is_no_end_of_the_interval(found):
    def ends(*simulated):
        return [*outcomes.activation(outcomes.Findings(found.graph, None, simulated)).values()]

    below, above = 0.6, 0.4
    assert ends() == pytest.approx([below, above])
    # a motion without impacts above both, one with impacts below both
    assert ends((0.7, {"impacts_per_period": 0.0}, "")) == pytest.approx([np.nan, above], nan_ok=True)
    assert ends((0.3, {"impacts_per_period": 2.0}, "")) == pytest.approx([below, np.nan], nan_ok=True)
    for name in ("B0", "B1"):
        found.graph.branches[name].values = np.linspace(0.0, 1.0, 61)
    assert np.isnan(ends()).all()
    del found.graph.branches["B0"]  # no motion without impacts
    assert np.isnan(ends()).all()
