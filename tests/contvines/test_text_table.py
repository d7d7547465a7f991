"""Tables and sentences that fit: no line is longer than it may be, and nothing is lost on the way."""

import re

from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from contvines.text_table import Table, fitted

words = st.sampled_from(("a", "b..c", "B1", "->", "wall-graze", "0.25..1.27", "supercritic"))
cells = st.lists(words, max_size=6).map(" ".join)
unhurried = settings(deadline=None, max_examples=50, suppress_health_check=[HealthCheck.too_slow])


@unhurried
@given(st.lists(st.tuples(words, cells, cells, cells), min_size=1, max_size=6), st.integers(36, 140))
def test_no_line_is_longer_than_the_terminal_and_every_word_is_there(rows, width):
    table = Table(("label", "kind", "value", "leads to"), rows)
    lines = table.lines(width)
    assert all(len(line) <= width for line in lines)
    shown = " ".join(lines).split()
    for row in rows:
        for cell in row:
            for word in cell.split():
                assert word in shown
    assert len(table.lines()) == len(rows) + 1  # a pipe gets one line each


def test_spare_columns_go_first_and_cells_stand_below_one_another_at_last():
    table = Table(("point", "kind", "leads to"), [("SB1", "symmetry-breaking", "B1 -> B2")], ("kind",))
    assert table.lines(40)[1] == "SB1    symmetry-breaking  B1 -> B2"
    assert table.lines(30) == ["point  leads to", "SB1    B1 -> B2"]
    narrow = Table(("point", "kind", "on"), [("SB1", "symmetry-breaking", "a-very-long-branch")])
    assert narrow.lines(32) == ["point SB1", "  kind  symmetry-breaking", "  on    a-very-long-branch"]


@unhurried
@given(st.lists(words, min_size=1, max_size=40).map(" ".join), st.integers(20, 100))
def test_a_long_sentence_goes_on_below_set_in(text, width):
    lines = fitted(text, width).split("\n")
    assert all(len(line) <= width for line in lines)
    assert " ".join(line.strip() for line in lines) == text
    assert all(re.match(r"  \S", line) for line in lines[1:])
