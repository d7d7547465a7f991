"""The table that people read: names, short words."""

import dataclasses

import pytest

import contvines as cv
from contvines.graph.table import table
from tests.contvines import fakes
from tests.contvines.graph.test_borders import Line, folding


def test_the_table_names_the_stuck_motion_and_stays_narrow():
    graph = fakes.pitchfork_graph()
    words = ("", "LtLRLttR" * 64, "LR" * 99 + "tt")
    for branch, word in zip(graph.branches.values(), words, strict=True):
        branch.description = {
            "word": word,
            "periods": 1,
            "name": "stuck" if not word else "P",
            "symmetric": not word,
        }
    graph.special["VG1"].kind = "velocity-graze"
    lines = str(graph).splitlines()
    assert any(line.split()[:4] == ["B1", "stuck", "k=1", "symmetric"] for line in lines)
    assert any(line.split()[:2] == ["B2", "(LtLRLttR)^64"] for line in lines)
    assert max(map(len, lines)) < 160
    assert [b["word"] for b in graph.to_dict()["branches"]] == list(words)


@pytest.mark.parametrize("width", [60, 80, 100, 140])
def test_a_table_fits_its_terminal_and_keeps_the_labels(width):
    graph = fakes.pitchfork_graph()
    graph.switches[0] = dataclasses.replace(graph.switches[0], note="a long remark " * 20)
    text = table(graph, width)
    assert max(map(len, text.splitlines())) <= width
    for label in (*graph.branches, *graph.special):
        assert any(line.startswith(label) for line in text.splitlines())


def test_ends_are_labels_and_zero_is_zero():
    graph = fakes.pitchfork_graph()
    rows = {line.split()[0]: line for line in table(graph).splitlines() if line}
    assert rows["B2"].endswith("BP1 .. EP1")
    graph.special["BP1"].value = 3.2e-19
    assert " 0 " in next(line for line in table(graph).splitlines() if line.startswith("BP1"))


def test_a_border_at_which_nothing_goes_on_says_why():
    graph = cv.diagram(Line("a", 0.0, 1.0, [-1.0], [0.5], [folding]), within=(0.0, 1.0), depth=0)
    (row,) = (line for line in table(graph).splitlines() if line.startswith("VG1"))
    assert "(the solutions found beyond are not followed: depth = 0)" in row
    graph = cv.diagram(Line("a", 0.0, 1.0, [-1.0], [0.5], [folding]), within=(0.0, 1.0), depth=1)
    (row,) = (line for line in table(graph).splitlines() if line.startswith("VG1"))
    assert "depth" not in row and "B1 -> B2 (nonsmooth fold)" in row
