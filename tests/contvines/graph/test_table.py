"""The table that people read: names, short words."""

import dataclasses

import pytest

from contvines.graph.table import short_word, table, told_apart
from tests.contvines import fakes


def test_the_table_names_the_stuck_motion_and_stays_narrow():
    graph = fakes.pitchfork_graph()
    words = ("", "LtLRLttR" * 64, "LR" * 99 + "tt")
    for branch, word in zip(graph.branches.values(), words, strict=True):
        name = "P" if word else "stuck"
        branch.description = {"word": word, "periods": 1, "name": name, "symmetric": not word}
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
    lines = table(graph, width).splitlines()
    assert max(map(len, lines)) <= width
    for label in (*graph.branches, *graph.special):
        assert any(line.startswith(label) for line in lines)


def test_ends_are_labels_and_zero_is_zero():
    graph = fakes.pitchfork_graph()
    graph.special["BP1"].value = 3.2e-19
    rows = {line.split()[0]: line for line in table(graph).splitlines() if line}
    assert rows["B2"].endswith("BP1 .. EP1")
    assert any(line.startswith("BP1") and " 0 " in line for line in table(graph).splitlines())


SHORT = {
    "LtRLttR" * 8: "(LtRLttR)^8",
    "deep+ holds- deep- holds+": "deep+ holds-... 4 events",
    "holds-[--] deep+[+-] holds+[++] deep-[-+]": "holds-[--]... 4 events",
    "hit stick_1 slip_1 hit stick_1 slip_1 hit stick_1 slip_1": "(hit stick_1 slip_1)^3",
    "s+LtRLttRLtRLttRLLtRtttLsLR": "s+LtRLttRLtRLttR... 26 events",
    "holds-[--] holds+": "holds-[--] holds+",
}


def test_what_long_words_become():
    """What is left out is counted."""
    assert {word: short_word(word) for word in SHORT} == SHORT


def test_different_words_have_different_short_forms():
    words = ["L1 t2 t2 R1 R2 L2", "L1 t2 L2 R2 R1 L2", "LR", "LR"]
    short = told_apart(words, 14)
    assert list(short) == words[:3] and len(set(short.values())) == 3
    assert short["LR"] == "LR"
