"""The network: boxes, arrows and captions."""

import dataclasses
import itertools

import numpy as np
import pytest

from contvines.graph.graph import Switch
from contvines.plots import plot_network
from tests.contvines import fakes


@pytest.fixture
def graph():
    return fakes.pitchfork_graph()


def test_network_has_a_box_per_branch_and_names_the_switches(graph):
    texts = [t.get_text() for t in plot_network(graph).axes[0].texts]
    assert [t.split()[0] for t in texts[:3]] == ["B1", "B2", "B3"]
    assert texts[3:] == ["BP1", "VG1"]


def chain(length):
    """A graph of branches one behind the other, real ones of one point and narrow ranges."""
    graph = fakes.pitchfork_graph()
    first = graph.branches["B2"]
    names = [f"B{i + 1}" for i in range(length)]
    graph.branches = {n: dataclasses.replace(first, label=n, seed=None, marks=()) for n in names}
    graph.switches = [Switch("VG1", a, b, "velocity-graze") for a, b in itertools.pairwise(names)]
    return graph


def test_a_long_network_goes_on_below():
    figure = plot_network(chain(20))
    assert figure.get_size_inches()[0] < 25
    texts = figure.axes[0].texts[:20]
    assert [t.get_text().split()[0] for t in texts] == [f"B{i + 1}" for i in range(20)]
    places = np.array([t.get_position() for t in texts])
    steps = np.abs(np.diff(places, axis=0))
    assert np.allclose(steps.sum(axis=1), 1)  # each box stands beside the one before
    assert len({tuple(p) for p in places}) == 20
    figure.canvas.draw()
    boxes = [t.get_window_extent() for t in texts]
    assert not any(a.overlaps(b) for a, b in itertools.combinations(boxes, 2))


def test_arrows_past_a_box_have_their_labels_beside_it():
    graph = chain(9)  # the seventh to ninth branch leave the sixth: below it, one under the other
    graph.switches[6:] = [Switch(f"PD{i}", "B6", f"B{i}", "period-doubling") for i in (8, 9)]
    figure = plot_network(graph)
    figure.canvas.draw()
    boxes, labels = figure.axes[0].texts[:9], figure.axes[0].texts[9:]
    assert {"PD8", "PD9"} <= {t.get_text() for t in labels}
    for label in labels:
        extent = label.get_window_extent()
        assert not any(extent.overlaps(box.get_window_extent()) for box in boxes)
        assert figure.bbox.x0 < extent.x0 and extent.x1 < figure.bbox.x1


def test_network_captions_tell_ends_apart_and_shorten_words():
    graph = chain(3)
    one, two, three = graph.branches.values()
    one.values = np.linspace(0.990001, 0.990002, 31)
    two.values = np.full(31, 0.25)
    for branch, word in ((one, "LtRLttR" * 8), (two, ""), (three, "LR")):
        branch.description = {"word": word, "periods": 1, "name": "stuck" if not word else "P"}
    texts = [t.get_text() for t in plot_network(graph).axes[0].texts[:3]]
    assert texts[0] == "B1  (LtRLttR)^8  k=1\np 0.990001 to 0.990002"
    assert texts[1] == "B2  stuck  k=1\np 0.25"
    assert texts[2].startswith("B3  LR  k=1")


def test_a_small_network_leaves_out_what_finds_no_room_and_says_how_much():
    graph = chain(40)  # three leave the second, and nine each of these
    graph.switches = [Switch("PD1", "B1", "B2", "period-doubling")]
    graph.switches += [Switch(f"WG{i}", "B2", f"B{i}", "wall-graze") for i in (3, 4, 5)]
    graph.switches += [Switch(f"VG{i}", f"B{3 + i % 3}", f"B{i}", "velocity-graze") for i in range(6, 33)]
    graph.switches += [Switch(f"ST{i}", "B20", f"B{i}", "stick") for i in range(33, 41)]
    figure = plot_network(graph, figsize=(3.4, 2.4))
    figure.canvas.draw()
    axes = figure.axes[0]
    texts = [text.get_text() for text in axes.texts]
    assert texts == ["B1", "B2", "B3", "B4", "B5", "PD1", "WG3", "WG4", "WG5"]
    assert axes.get_title(loc="left").endswith("; 35 more further on")
    boxes = [text.get_window_extent() for text in axes.texts]
    assert not any(a.overlaps(b) for a, b in itertools.combinations(boxes, 2))
    assert len(plot_network(graph).axes[0].texts) == 40 + len(graph.switches)  # a large one has all
