"""The journal beside an unfinished sweep: what counts when the same sweep is asked for again, and what does not."""

import json

import pytest

from contvines.command.study import check_study
from contvines.command.sweep_rows import Kept, Rows

STUDY = {
    "model": {"name": "absorber", "restitution": 0.76, "friction": 0.5, "gravity": 0.211},
    "start": {"word": "LR", "periods": 1, "amplitude": 0.55},
    "continue": {"parameter": "amplitude", "within": [0.2, 1.2], "depth": 1},
    "sweep": {"count": 9},
}


def study(**sections):
    return check_study({name: {**part, **sections.get(name, {})} for name, part in STUDY.items()})


def row(value):
    cells = [repr(value), "up", "periodic", "LR", "1", "2", "0.5", "1", "[]"]
    return Kept(cells, "periodic", True, [0.5], [0.1, 0.2, 0.3, 1.0, 0.0, 0.0])


@pytest.fixture
def target(tmp_path):
    """A sweep that stopped after three values."""
    path = tmp_path / "s.csv"
    with pytest.raises(KeyboardInterrupt), Rows(path, study(), False, ["B"]) as rows:
        for value in (0.2, 0.325, 0.45):
            rows.keep(row(value))
        raise KeyboardInterrupt
    return path


def found(target, asked=None, down=False):
    with pytest.raises(KeyboardInterrupt), Rows(target, asked or study(), down, ["B"]) as rows:
        values = [r.value for r in rows.rows]
        raise KeyboardInterrupt
    return values


def journal(target):
    return target.with_name("s.csv.unfinished")


def test_the_same_sweep_goes_on(target):
    assert found(target) == [0.2, 0.325, 0.45]
    assert [line.split(",")[0] for line in target.read_text().splitlines()] == [
        "value",
        "0.2",
        "0.325",
        "0.45",
    ]
    with Rows(target, study(), False, ["B"]) as rows:
        rows.keep(row(0.575))
        assert [r.value for r in rows.rows] == [0.2, 0.325, 0.45, 0.575]
    assert not journal(target).exists()  # finished


@pytest.mark.parametrize("cut", [1, 2, 40])
def test_a_line_that_a_kill_cut_short_is_left_out(target, cut):
    journal(target).write_bytes(journal(target).read_bytes()[:-cut])
    assert found(target) == [0.2, 0.325]
    assert found(target) == [0.2, 0.325]  # and the journal is whole again


def test_rows_before_a_broken_line_count(target):
    lines = journal(target).read_text().splitlines()
    lines[2] = lines[2][:30]
    journal(target).write_text("\n".join([*lines, ""]))
    assert found(target) == [0.2]


@pytest.mark.parametrize(
    "other",
    [
        {"model": {"friction": 0.4}},
        {"start": {"amplitude": 0.6}},
        {"start": {"word": "RL"}},
        {"continue": {"within": [0.2, 1.3]}},
        {"sweep": {"count": 10}},
        {"sweep": {"transient": 77}},
    ],
)
def test_rows_of_another_study_do_not(target, other):
    assert found(target, study(**other)) == []


def test_rows_of_the_way_back_do_not(target):
    assert found(target, down=True) == []


@pytest.mark.parametrize("header", ["{}", '{"contvines": "unfinished sweep"}', "", "[]", "not JSON"])
def test_a_journal_with_another_head_is_no_journal_of_this_sweep(target, header):
    lines = journal(target).read_text().splitlines()
    journal(target).write_text("\n".join([header, *lines[1:], ""]))
    assert found(target) == []


def test_the_journal_alone_is_not_enough(target):
    """Without the table beside it nothing is gone on with."""
    assert json.loads(journal(target).read_text().splitlines()[0])["contvines"] == "unfinished sweep"
    target.unlink()
    assert found(target) == []
