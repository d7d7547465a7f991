"""The rows of an unfinished survey: those that are whole are taken up, those of another survey are not."""

import json

import pytest

from contvines.survey.journal import Rows
from contvines.survey.work import Row

HEADER = {"survey": 1, "of": "circles"}


def row(index, note=""):
    return Row(index, {"peak": 0.5 * index}, note)


def lines(path):
    return [json.loads(line.partition(" ")[2]) for line in path.read_text().splitlines()]


@pytest.fixture
def kept(tmp_path):
    path = tmp_path / "rows"
    with Rows(path, HEADER) as rows:
        for index in range(3):
            rows.keep(row(index, "a long sentence" * index))
    return path


def test_whole_rows_are_found_again_and_more_follow(kept):
    with Rows(kept, HEADER) as rows:
        assert sorted(rows.found) == [0, 1, 2]
        rows.keep(row(3))
    with Rows(kept, HEADER) as rows:
        assert sorted(rows.found) == [0, 1, 2, 3]
    assert [line.get("index") for line in lines(kept)] == [None, 0, 1, 2, 3]


@pytest.mark.parametrize("cut", [1, 2, 9])
def test_a_line_cut_short_is_left_out_and_written_over(kept, cut):
    kept.write_bytes(kept.read_bytes()[:-cut])
    with Rows(kept, HEADER) as rows:
        assert sorted(rows.found) == [0, 1]
        rows.keep(row(7))
    assert [line.get("index") for line in lines(kept)] == [None, 0, 1, 7]


def test_a_damaged_line_and_those_after_it_are_worked_out_again(kept):
    content = bytearray(kept.read_bytes())
    content[content.index(b"0.5")] ^= 1  # 0.5 becomes 1.5
    kept.write_bytes(content)
    with Rows(kept, HEADER) as rows:
        assert sorted(rows.found) == [0]
        rows.keep(row(1))
    with Rows(kept, HEADER) as rows:
        assert rows.found[1].columns == {"peak": 0.5}


@pytest.mark.parametrize("other", [{"survey": 1, "of": "squares"}, {"survey": 1}, {}])
def test_rows_of_another_survey_are_not_taken(kept, other):
    with Rows(kept, other) as rows:
        assert rows.found == {}
    assert lines(kept) == [other]


def test_a_finished_survey_leaves_none(kept):
    with Rows(kept, HEADER) as rows:
        rows.finish()
    assert not kept.exists()
