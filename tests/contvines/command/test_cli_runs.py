"""The commands that compute, one after the other on one study, as a user would."""

import csv
import json
import math

import pytest

from contvines.command.cli import main
from contvines.graph.persistence import same_graph
from contvines.store import load
from tests.contvines.studies import PAPER_MACHINE

STUDY = (
    PAPER_MACHINE
    + """[start]
word = "LR"
periods = 1
amplitude = 0.55
[continue]
parameter = "amplitude"
within = [0.2, 1.2]
depth = {depth}
virtual = {virtual}
"""
)


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """A folder with a study and its finished diagram."""
    path = tmp_path_factory.mktemp("runs")
    (path / "s.toml").write_text(STUDY.format(depth=1, virtual="false"))
    (path / "v.toml").write_text(STUDY.format(depth=2, virtual="true"))
    call("diagram", path / "s.toml", "-o", path / "s.vines", "--quiet")
    return path


def call(*words):
    try:
        main([str(w) for w in words])
    except SystemExit as end:
        assert not end.code, f"exit status {end.code}"


def test_show_keeps_the_contract(folder, capsys):
    call("show", folder / "s.vines", "--json")
    data = json.loads(capsys.readouterr().out)
    assert {"model", "parameter", "branches", "special", "switches"} <= set(data)
    branch = {
        "label",
        "word",
        "periods",
        "impacts",
        "symmetric",
        "real",
        "range",
        "points",
        "stable",
        "ended",
    }
    special = {"label", "kind", "branch", "value", "multipliers", "real", "criticality", "residual", "replay"}
    assert all(branch <= set(b) for b in data["branches"])
    assert all(special <= set(p) for p in data["special"])
    assert all({"point", "from", "to"} <= set(s) for s in data["switches"])
    first = data["branches"][0]
    assert (first["label"], first["word"], first["periods"], first["impacts"]) == ("B1", "LR", 1, 2)
    assert first["symmetric"] is True and first["real"] is True
    kinds = {p["kind"] for p in data["special"]}
    assert {"fold", "symmetry-breaking", "velocity-graze", "end"} <= kinds
    for point in data["special"]:
        assert set(point["value"]) == {"amplitude"}
        assert all(len(m) == 2 for m in point["multipliers"])
        assert point["criticality"] in (None, "supercritical", "subcritical")
        assert point["residual"] < 1e-10
        assert point["replay"] is None or point["replay"] < 1e-6
    labels = {b["label"] for b in data["branches"]}
    assert {s["from"] for s in data["switches"]} | {s["to"] for s in data["switches"]} <= labels


def test_orbit_of_a_label_is_the_object_of_the_contract(folder, capsys):
    call("orbit", folder / "s.vines", "SB1", "--json")
    data = json.loads(capsys.readouterr().out)
    assert [set(n) >= {"event", "phase", "B_pre", "B_post", "w", "w_rate"} for n in data["nodes"]] == [
        True,
        True,
    ]
    # a symmetry breaking: one multiplier of the full period is +1 (MODEL: -1 of the half map)
    assert min(abs(complex(*m) - 1) for m in data["multipliers"]) < 1e-6
    assert all({"kind", "segment", "value"} <= set(m) for m in data["margins"])
    call("orbit", folder / "s.vines", "B1:3")
    assert "multipliers:" in capsys.readouterr().out


def test_trace_follows_one_branch(folder, capsys, monkeypatch):
    monkeypatch.chdir(folder)  # where s.vines, the diagram, is: its name is not taken
    call("trace", folder / "s.toml")
    graph = load(folder / "s-trace.vines", problems=False)
    assert list(graph.branches) == ["B1"]
    assert not graph.switches
    whole = load(folder / "s.vines", problems=False)
    assert graph.branches["B1"].points.tobytes() == whole.branches["B1"].points.tobytes()


def test_switch_adds_the_branch_that_leaves_a_point(folder, capsys):
    call("trace", folder / "s.toml", "-o", folder / "w.vines", "--quiet")
    call("switch", folder / "w.vines", "SB1")
    assert "points, amplitude from 0.7268" in capsys.readouterr().out
    graph = load(folder / "w.vines", problems=False)
    (switch,) = [s for s in graph.switches if s.point == "SB1"]
    assert switch.source == "B1"
    assert graph.branches[switch.target].description["symmetric"] is False
    assert graph.special["SB1"].mirror
    before = (folder / "w.vines").read_bytes()
    call("switch", folder / "w.vines", "SB1")
    assert "already: B2; " in capsys.readouterr().out
    assert (folder / "w.vines").read_bytes() == before


def test_virtual_branches_are_marked_and_only_there_on_request(folder):
    call("diagram", folder / "v.toml", "-o", folder / "v.vines", "--quiet", "--plot", folder / "v.png")
    graph = load(folder / "v.vines", problems=False)
    assert all(b.real for b in load(folder / "s.vines", problems=False).branches.values())
    virtual = [b.label for b in graph.branches.values() if not b.real]
    assert virtual
    # the published period doubling of the bare maps, at C^2 = 0.8679, lies on a virtual branch
    doublings = [p for p in graph.of_kind("period-doubling") if abs(p.value**2 - 0.8679) < 5e-5]
    assert [(p.real, p.branch in virtual) for p in doublings] == [(False, True)]


def test_a_start_that_is_not_there_says_what_was_tried(tmp_path, capsys):
    text = STUDY.format(depth=1, virtual="false").replace("amplitude = 0.55", "amplitude = 0.21")
    (tmp_path / "n.toml").write_text(text)
    with pytest.raises(SystemExit) as end:
        main(["diagram", str(tmp_path / "n.toml"), "-o", str(tmp_path / "n.vines")])
    err = capsys.readouterr().err
    assert end.value.code == 1
    assert (
        "n.toml: [start] no orbit 'LR' with periods = 1 was found at amplitude = 0.21; tried: the closed forms"
        in err
    )
    assert "the nearest motion that the simulator finds is 'tt'" in err
    assert not (tmp_path / "n.vines").exists()


def test_sweep_is_drawn_over_the_branches(folder):
    text = (folder / "s.toml").read_text() + "\n[sweep]\nwithin = [0.6, 0.8]\ncount = 5\ntransient = 50\n"
    (folder / "o.toml").write_text(text)
    call(
        "sweep",
        folder / "o.toml",
        "-o",
        folder / "o.csv",
        "--over",
        folder / "s.vines",
        "--plot",
        folder / "o.png",
        "-q",
    )
    assert (folder / "o.png").stat().st_size > 10_000


def test_a_graph_that_was_cut_says_so(tmp_path, capsys):
    (tmp_path / "c.toml").write_text(STUDY.format(depth=3, virtual="false") + "max_branches = 2\n")
    call("diagram", tmp_path / "c.toml", "-o", tmp_path / "c.vines")
    assert "max_branches = 2" in capsys.readouterr().out
    call("show", tmp_path / "c.vines", "--json")
    cut = json.loads(capsys.readouterr().out)
    assert len(cut["branches"]) == 2 and "max_branches = 2" in cut["message"]


def test_a_guess_that_leads_nowhere_is_not_dropped_silently(tmp_path, capsys):
    text = STUDY.format(depth=0, virtual="false").replace(
        'word = "LR"', 'word = "LR"\nguess = [[1e300, 2.0], [3.0, 1e300]]'
    )
    (tmp_path / "g.toml").write_text(text)
    call("diagram", tmp_path / "g.toml", "-o", tmp_path / "g.vines", "--quiet")
    said = capsys.readouterr().err
    assert "the guess does not lead to an orbit 'LR'" in said and "found by simulation" in said


def test_export_has_the_measures_of_every_point(folder, monkeypatch):
    monkeypatch.chdir(folder)
    call("export", "s.vines", "--to", "csv")
    with open("s.csv", newline="") as file:
        rows = [row for row in csv.DictReader(file) if row["branch"] == "B1"]
    assert {(row["word"], row["periods"]) for row in rows} == {("LR", "1")}
    for row in rows:
        assert float(row["C2"]) == pytest.approx(float(row["amplitude"]) ** 2, rel=1e-14)
        assert float(row["B_post"]) == pytest.approx(
            float(row["u1"]), abs=1e-15
        )  # the first event is an impact on the left wall
        # LR on the impacting manifold C^2 = (1 - pi B/2)^2 + (R B + h)^2, friction included in h
        B, R, h = float(row["B"]), 0.24 / 1.76, math.pi / 2 * 1.006 * 0.5 * 0.211
        assert float(row["C2"]) == pytest.approx((1 - math.pi * B / 2) ** 2 + (R * B + h) ** 2, rel=1e-9)
        assert float(row["friction_loss"]) == pytest.approx(0.5 * 0.211 * 4, rel=1e-14)


def test_large_results_are_told_in_brief(folder, capsys, monkeypatch):
    """A summary and where the tables are, or with --details the tables; one way for diagrams, atlases and charts."""
    monkeypatch.setattr("contvines.command.frame.MANY", 0)
    monkeypatch.chdir(folder)
    atlas = "[atlas]\nvalues = [0.5, 1.0]\nstarts = 4\nscan = 0\n"
    (folder / "a.toml").write_text(STUDY.format(depth=0, virtual="false") + atlas)
    for words in (["diagram", "s.toml", "-o", "s.vines", "--no-look"], ["atlas", "a.toml"]):
        call(*words)
        brief = capsys.readouterr().out
        assert "stable motions of" in brief and "contvines show" in brief and "from .. to" not in brief
        call(*words, "--details")
        assert "from .. to" in capsys.readouterr().out


def test_an_atlas_goes_on_with_a_larger_budget(folder, capsys, monkeypatch):
    """The file of the small one is not set aside; the result is that of the large one alone."""
    monkeypatch.chdir(folder)
    atlas = "[atlas]\nvalues = [0.5, 1.0]\nstarts = 4\nscan = 0\n"
    (folder / "b.toml").write_text(STUDY.format(depth=0, virtual="false") + atlas)
    call("atlas", "b.toml", "--budget", "1")
    said = capsys.readouterr()
    assert "left out are" in said.out and "contvines atlas b.toml --budget 2 goes on" in said.err
    call("atlas", "b.toml")
    assert "nothing to compute" not in (said := capsys.readouterr()).err and "left out" not in said.out
    call("atlas", "b.toml", "-o", "alone.vines", "--quiet")
    parts, alone = (load(folder / name, problems=False) for name in ("b-atlas.vines", "alone.vines"))
    assert same_graph(parts, alone) and not (folder / "b-atlas.old.vines").exists()
