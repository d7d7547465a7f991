"""The data of a report are the graph's own numbers."""

import base64
import gzip
import json
import re

import numpy as np
import pytest

import contvines as cv
from contvines.report.contents import contents
from contvines.report.page import write_report
from tests.contvines import fakes
from tests.machines import absorber_graph


@pytest.fixture(scope="module")
def graph():
    return absorber_graph(0.55, (0.4, 0.8), depth=1)


def test_curves_special_points_and_orbits_are_the_graphs(graph):
    data = contents(graph, "x.vines")
    one = data["branches"][0]
    assert np.allclose(one["measures"]["amplitude"], graph["B1"].values, rtol=1e-8)
    assert np.allclose(one["measures"]["B"], graph["B1"].measure("B"), rtol=1e-8)
    assert [p["label"] for p in data["special"]] == list(graph.special)
    sb = next(p for p in data["special"] if p["label"] == "SB1")
    assert sb["value"]["amplitude"] == pytest.approx(graph["SB1"].value, abs=1e-12)
    scene = data["orbits"]["B1"][str(sb["index"])]
    assert [e["event"] for e in scene["events"]] == ["L", "R"]
    # v = C sin(phase) moves the common centre: q1 = (v + eps w)/(1 + eps)
    turns, cavity = (np.array(v) for v in (scene["history"]["x"], scene["history"]["curves"]["cavity"]))
    v = sb["value"]["amplitude"] * np.sin(2 * np.pi * turns)
    w = np.array(scene["portrait"]["x"])
    assert np.abs(cavity - (v + 0.006 * w) / 1.006).max() < 5e-4  # five digits are kept


def test_special_points_keep_their_orbits_however_many_points_there_are(graph, monkeypatch):
    from contvines.report import contents as module

    monkeypatch.setattr(module, "NUMBERS", 10_000)
    orbits = contents(graph, "x.vines")["orbits"]
    assert sum(len(scenes) for scenes in orbits.values()) < sum(len(b) for b in graph)
    for branch in graph:
        assert {str(i) for i, _ in branch.marks} <= set(orbits[branch.label])


def test_a_problem_without_motions_has_a_page_too():
    circle = cv.AlgebraicProblem(lambda u, p: u**2 + p**2 - 1, [1.0], 0.0)
    data = contents(cv.diagram(circle, within=(-2.0, 2.0)), "circle.vines")
    assert data["orbits"] == {} and len(data["branches"]) == 1
    assert contents(fakes.pitchfork_graph(), "g.vines")["branches"][2]["real"] is False


def test_the_page_asks_for_nothing_and_names_cannot_break_out_of_it(graph, tmp_path):
    name = "</script><b>x.vines"
    text = write_report(graph, tmp_path / "page.html", name).read_text("utf-8")
    assert not re.search(r"""(?:src|href)\s*=\s*["'](?!data:)""", text) and name not in text
    packed = re.search(r'id="data" type="application/gzip">([^<]+)<', text)
    assert packed is not None
    assert json.loads(gzip.decompress(base64.b64decode(packed[1])))["source"] == name
