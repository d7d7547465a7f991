"""`contvines sweep`: its rows lead to starts, an interrupted run goes on, and what cannot be is refused in time."""

import csv
import json
from pathlib import Path

import numpy as np
import pytest

from contvines.command.cli import main
from tests.contvines.studies import PAPER_MACHINE

REDUCED = (
    PAPER_MACHINE
    + """[start]
word = "{word}"
periods = {periods}
amplitude = {value}
{guess}
[continue]
parameter = "amplitude"
within = [0.05, 2.5]
depth = 0
[sweep]
within = {within}
count = {count}
transient = 100
"""
)
COUPLED = """
[model]
name = "coupled"
restitution = {restitution}
friction = 0.5
gravity = 0.211
mass_ratio = 0.006
damping = 1.0
forcing = 2.47
[start]
word = "{word}"
periods = {periods}
frequency = {value}
{guess}
[continue]
parameter = "frequency"
within = [0.9, 1.1]
depth = 0
[sweep]
within = {within}
count = {count}
transient = 150
"""


def study(
    form, path, word="LR", periods=1, value=1.0, guess="", within=(0.2, 1.2), count=9, restitution=0.76
):
    path.write_text(
        form.format(
            word=word,
            periods=periods,
            value=value,
            guess=guess,
            within=list(within),
            count=count,
            restitution=restitution,
        )
    )
    return path


@pytest.fixture
def run(capsys, monkeypatch, tmp_path):
    monkeypatch.chdir(tmp_path)

    def go(*words):
        try:
            main([str(w) for w in words])
            status = 0
        except SystemExit as end:
            status = end.code or 0
        return (status, *capsys.readouterr())

    return go


def table(path):
    with Path(path).open(newline="") as file:
        return list(csv.DictReader(file))


# ------------------------------------------------------------------ from a row to a start
@pytest.mark.parametrize(
    "form, parameter, within, count, words",
    [
        (REDUCED, "amplitude", (0.12, 1.3), 20, {"LR", "ss", "tt", "LRs", "LRLt"}),
        (COUPLED, "frequency", (0.93, 1.07), 12, {"LR", "ss", "tt", "LRtRtt"}),
    ],
)
def test_a_row_is_a_start_of_the_same_orbit(run, tmp_path, form, parameter, within, count, words):
    """Word, periods and nodes pasted into [start] give the simulator's orbit; its multipliers are differences."""
    from contvines.command.compose import machine
    from contvines.command.study import read_study
    from orbits.attractors import sweep

    path = study(form, tmp_path / "a.toml", within=within, count=count)
    assert run("sweep", path, "-q", "-o", "a.csv")[0] == 0
    rows = table("a.csv")
    assert list(rows[0])[:6] == ["value", "direction", "attractor", "word", "periods", "impacts"]
    assert list(rows[0])[-2:] == ["symmetric", "nodes"]
    read = read_study(path)
    others = {k: v for k, v in read.loose.items() if k != parameter}
    seen = sweep(
        machine(read), parameter, [float(r["value"]) for r in rows], transient=read.sweep.transient, **others
    )
    tried = set()
    for row, known in zip(rows, seen):
        if row["attractor"] in ("stuck", "chaotic", "chatter"):
            assert row["nodes"] == ("[]" if row["attractor"] == "stuck" else "")
            continue
        again = study(
            form,
            tmp_path / "b.toml",
            row["word"],
            row["periods"],
            row["value"],
            f"guess = {row['nodes']}",
        )
        status, out, err = run("orbit", again, "--json")
        assert (status, err) == (0, ""), err
        orbit = json.loads(out)
        nodes = np.array(json.loads(row["nodes"]))
        found = [
            [
                n["phase"],
                n["B_post"] if n["event"] in "LR" else n["w"],
                *((n["v"], n["v_rate"]) if "v" in n else ()),
            ]
            for n in orbit["nodes"]
        ]
        gap = np.array(found) - nodes
        gap[:, 0] -= 2 * np.pi * np.round(gap[0, 0] / (2 * np.pi))
        assert np.abs(gap).max() < 1e-7
        theirs = np.sort(np.abs(known.detail.multipliers))
        ours = np.sort(np.abs([complex(*m) for m in orbit["multipliers"]]))
        assert ours[-1] == pytest.approx(theirs[theirs < 1 - 1e-6][-1], abs=2e-6)
        assert row["symmetric"] == ("1" if known.detail.symmetric else "0")
        tried.add(row["word"])
    assert words <= tried


# ------------------------------------------------------------------ interrupted and resumed
@pytest.mark.slow
@pytest.mark.parametrize(
    "form, within, options", [(REDUCED, (0.9, 1.6), ("--down",)), (COUPLED, (0.985, 1.0), ())]
)
def test_an_interrupted_sweep_goes_on_to_the_same_rows(run, tmp_path, monkeypatch, form, within, options):
    from contvines.command import sweep_rows

    path = study(form, tmp_path / "a.toml", within=within)
    assert run("sweep", path, "-o", "whole.csv", *options)[0] == 0
    plain, done = sweep_rows.Rows.keep, []

    def stop(self, row):
        if len(done) == 4:
            raise KeyboardInterrupt
        done.append(row)
        plain(self, row)

    monkeypatch.setattr(sweep_rows.Rows, "keep", stop)
    status, _, err = run("sweep", path, "-o", "part.csv", *options)
    assert status == 130
    assert (
        "4 of 9 values are kept in part.csv; the same command goes on from there, from the state reached"
        in err
    )
    assert len(table("part.csv")) == 4
    with Path("part.csv.unfinished").open("a") as file:
        file.write('{"cells": ["0.9')  # a kill in the middle of a line
    monkeypatch.setattr(sweep_rows.Rows, "keep", plain)
    status, _, err = run("sweep", path, "-o", "part.csv", "--plot", "part.png", *options)
    assert status == 0 and "part.csv is unfinished: going on after 4 of 9 values" in err
    assert Path("part.csv").read_bytes() == Path("whole.csv").read_bytes()
    assert not Path("part.csv.unfinished").exists() and Path("part.png").exists()


def test_what_another_study_left_is_not_gone_on_with(run, tmp_path, monkeypatch):
    from contvines.command import sweep_rows

    def stop(*_):
        raise KeyboardInterrupt

    path = study(REDUCED, tmp_path / "a.toml", count=3)
    plain = sweep_rows.Rows.keep
    monkeypatch.setattr(sweep_rows.Rows, "keep", stop)
    assert run("sweep", path)[0] == 130
    monkeypatch.setattr(sweep_rows.Rows, "keep", plain)
    status, _, err = run("sweep", path, "--down")
    assert status == 0 and "going on" not in err
    assert [row["direction"] for row in table("a-sweep.csv")] == ["down"] * 3


# ------------------------------------------------------------------ refused
def test_another_machine_beneath_is_refused_with_its_fields(run, tmp_path):
    path = study(COUPLED, tmp_path / "a.toml", value=1.02, within=(1.0, 1.05))
    other = study(COUPLED, tmp_path / "b.toml", value=1.03, within=(1.0, 1.05), restitution=0.6)
    assert run("trace", path, "-q", "-o", "a.vines")[0] == 0
    status, _, err = run("sweep", other, "--over", "a.vines", "--plot", "b.png")
    assert status == 1 and not Path("b-sweep.csv").exists()
    assert (
        "a.vines: this is the graph of another machine: restitution = 0.76 there and 0.6 in the study" in err
    )
    assert "forcing" not in err and "frequency =" not in err
    path.write_text(path.read_text().replace("frequency = 1.02", "frequency = 1.01"))
    assert run("sweep", path, "--over", "a.vines", "--plot", "a.png", "-q")[0] == 0
