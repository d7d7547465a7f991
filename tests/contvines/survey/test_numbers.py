"""Outcomes of made-up diagrams, by hand."""

from types import SimpleNamespace

import numpy as np
import pytest

import contvines as cv
from contvines.graph.stretches import highest, inside, stretches
from contvines.survey import outcomes


def branch(word, values, heights, real=True):
    values, heights = np.array(values, dtype=float), np.array(heights, dtype=float)
    return SimpleNamespace(
        real=real, problem=None, values=values, description={"word": word, "impacts": word.count("L")},
        measure=lambda name: heights, measure_names=("norm",), default_measure="", pieces=lambda: [(0, len(values) - 1, True)],
        stable_intervals=lambda: [(values.min(), values.max())], __len__=lambda: len(values),
    )  # fmt: skip


class Found(SimpleNamespace):
    def __len__(self):
        return len(self.values)


@pytest.fixture
def found(monkeypatch):
    """A low response `tt` from 0 to 0.6, a high one `LR` from 0.4 to 1, a virtual one, two overlapping stretches of `LRs`."""
    monkeypatch.setattr("contvines.graph.stretches.default_measure", lambda graph: "height")
    p = np.linspace(0.0, 1.0, 101)
    parts = [
        branch("tt", p[:61], 1.0 + p[:61]),
        branch("LR", p[40:], 3.0 - p[40:]),
        branch("LR", p, 9.0 + 0.0 * p, real=False),
        branch("LRs", p[70:81], 0.1 + 0.0 * p[70:81]),
        branch("LRs", p[75:91], 0.1 + 0.0 * p[75:91]),
    ]
    points = [
        SimpleNamespace(kind="fold", value=0.2, real=False),
        SimpleNamespace(kind="fold", value=0.7, real=True),
    ]
    graph = SimpleNamespace(
        within=(0.0, 1.0), branches={f"B{i}": Found(**vars(b)) for i, b in enumerate(parts)},
        of_kind=lambda kind: [q for q in points if q.kind == kind],
    )  # fmt: skip
    return outcomes.Findings(graph, None)


def test_peaks(found):
    assert outcomes.peak(found) == pytest.approx({"peak": 2.6, "peak_at": 0.4})
    lower = outcomes.lower_peak(found)  # tt up to 0.6, then LR until LRs is lower still
    assert lower["lower_peak"] == pytest.approx(2.4, abs=0.01) and lower["lower_peak_at"] == pytest.approx(
        0.6, abs=0.01
    )


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


def test_activation_is_no_end_of_the_interval(found):
    known = outcomes.activation(found)
    assert known["activation_from_below"] == pytest.approx(0.6) and known[
        "activation_from_above"
    ] == pytest.approx(0.4)
    for contradiction in [
        (0.7, 0.0),
        (0.3, 2.0),
    ]:  # a motion without impacts above both, one with impacts below both
        value, impacts = contradiction
        simulated = outcomes.Findings(found.graph, None, [(value, {"impacts_per_period": impacts}, "")])
        wrong = outcomes.activation(simulated)
        assert np.isnan(wrong["activation_from_below"]) == (impacts == 0.0)
        assert np.isnan(wrong["activation_from_above"]) == (impacts > 0.0)
    found.graph.branches["B0"].values = np.linspace(0.0, 1.0, 61)
    found.graph.branches["B1"].values = np.linspace(0.0, 1.0, 61)
    ends = outcomes.activation(found)
    assert np.isnan(ends["activation_from_below"]) and np.isnan(ends["activation_from_above"])


def test_activation_is_not_told_where_the_diagram_has_no_motion_without_impacts(found):
    del found.graph.branches["B0"]
    assert all(np.isnan(value) for value in outcomes.activation(found).values())
