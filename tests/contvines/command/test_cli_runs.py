"""The commands that compute, one after the other on one study, as a user would."""

import pytest

from contvines.command.cli import main
from contvines.graph.persistence import same_graph
from contvines.store import load
from tests.contvines.studies import PAPER

ATLAS = "[atlas]\nvalues = [0.5, 1.0]\nstarts = 4\nscan = 0\n"


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """A folder with studies, and the finished diagram of one."""
    path = tmp_path_factory.mktemp("runs")
    (path / "s.toml").write_text(PAPER.replace("depth = 0", "depth = 1"))
    (path / "v.toml").write_text(PAPER.replace("depth = 0", "depth = 2\nvirtual = true"))
    (path / "a.toml").write_text(PAPER + ATLAS)
    (path / "sweep.toml").write_text(PAPER + "[sweep]\nwithin = [0.6, 0.8]\ncount = 5\ntransient = 50\n")
    (path / "cut.toml").write_text(PAPER.replace("depth = 0", "depth = 3\nmax_branches = 2"))
    (path / "none.toml").write_text(PAPER.replace("amplitude = 0.55", "amplitude = 0.21"))
    far = 'word = "LR"\nguess = [[1e300, 2.0], [3.0, 1e300]]'
    (path / "far.toml").write_text(PAPER.replace('word = "LR"', far))
    with pytest.MonkeyPatch.context() as patch, pytest.raises(SystemExit):
        patch.chdir(path)
        main(["diagram", "s.toml", "--quiet"])
    return path


@pytest.fixture
def run(run, folder, monkeypatch):
    """Runs lines in the folder."""
    monkeypatch.chdir(folder)
    return run


def kept(name):
    return load(name, problems=False)


def test_show_keeps_the_contract(run):
    data = run.json("show s.vines")
    assert {"model", "parameter", "branches", "special", "switches"} <= set(data)
    fields = {
        "branches": "label word periods impacts symmetric real range points stable ended",
        "special": "label kind branch value multipliers real criticality residual replay",
        "switches": "point from to",
    }
    for part, names in fields.items():
        assert data[part] and all(set(names.split()) <= set(one) for one in data[part])
    first = {"label": "B1", "word": "LR", "periods": 1, "impacts": 2, "symmetric": True, "real": True}
    assert first.items() <= data["branches"][0].items()
    assert {"fold", "symmetry-breaking", "velocity-graze", "end"} <= {p["kind"] for p in data["special"]}
    for point in data["special"]:
        assert set(point["value"]) == {"amplitude"}
        assert all(len(m) == 2 for m in point["multipliers"])
        assert point["criticality"] in (None, "supercritical", "subcritical")
        assert point["residual"] < 1e-10
        assert point["replay"] is None or point["replay"] < 1e-6
    labels = {b["label"] for b in data["branches"]}
    assert {s[end] for s in data["switches"] for end in ("from", "to")} <= labels


def test_orbit_of_a_label_is_the_object_of_the_contract(run, folder):
    data = run.json("orbit s.vines SB1 --animate o.html")
    page = (folder / "o.html").read_text()
    assert "<script" in page and "image/png" in page
    assert len(data["nodes"]) == 2
    assert all(set(n) >= {"event", "phase", "B_pre", "B_post", "w", "w_rate"} for n in data["nodes"])
    # a symmetry breaking: one multiplier of the full period is +1 (MODEL: -1 of the half map)
    assert min(abs(complex(*m) - 1) for m in data["multipliers"]) < 1e-6
    assert all({"kind", "segment", "value"} <= set(m) for m in data["margins"])
    assert "multipliers:" in run.ok("orbit s.vines B1:3")


def test_trace_follows_one_branch(run):
    run.ok("trace s.toml")  # where s.vines, the diagram, is: its name is not taken
    graph = kept("s-trace.vines")
    assert list(graph.branches) == ["B1"] and not graph.switches
    assert graph["B1"].points.tobytes() == kept("s.vines")["B1"].points.tobytes()


def test_switch_adds_the_branch_that_leaves_a_point(run, folder):
    run.ok("trace s.toml -o w.vines --quiet")
    assert "points, amplitude from 0.7268" in run.ok("switch w.vines SB1")
    graph = kept("w.vines")
    (switch,) = [s for s in graph.switches if s.point == "SB1"]
    assert switch.source == "B1"
    assert graph[switch.target].description["symmetric"] is False
    assert graph["SB1"].mirror
    before = (folder / "w.vines").read_bytes()
    assert "already: B2; " in run.ok("switch w.vines SB1")
    assert (folder / "w.vines").read_bytes() == before


def test_virtual_branches_are_marked_and_only_there_on_request(run):
    run.ok("diagram v.toml --quiet --plot v.png")
    graph = kept("v.vines")
    assert all(branch.real for branch in kept("s.vines"))
    virtual = [branch.label for branch in graph if not branch.real]
    assert virtual
    # the published period doubling of the bare maps, at C^2 = 0.8679, lies on a virtual branch
    doublings = [p for p in graph.of_kind("period-doubling") if abs(p.value**2 - 0.8679) < 5e-5]
    assert [(p.real, p.branch in virtual) for p in doublings] == [(False, True)]


def test_a_start_that_is_not_there_says_what_was_tried(run, folder):
    status, _, said = run("diagram none.toml")
    assert status == 1
    tried = "no orbit 'LR' with periods = 1 was found at amplitude = 0.21; tried: the closed forms"
    assert f"none.toml: [start] {tried}" in said
    assert "the nearest motion that the simulator finds is 'tt'" in said
    assert not (folder / "none.vines").exists()


def test_a_graph_that_was_cut_says_so(run):
    assert "max_branches = 2" in run.ok("diagram cut.toml")
    cut = run.json("show cut.vines")
    assert len(cut["branches"]) == 2 and "max_branches = 2" in cut["message"]


def test_a_guess_that_leads_nowhere_is_not_dropped_silently(run):
    status, _, said = run("diagram far.toml --quiet")
    assert not status and "the guess does not lead to an orbit 'LR'" in said and "found by simulation" in said


@pytest.mark.parametrize("line", ["diagram s.toml --no-look", "atlas a.toml -o large.vines"])
def test_large_results_are_told_in_brief(run, monkeypatch, line):
    """A summary and where the tables are, or with --details the tables."""
    monkeypatch.setattr("contvines.command.frame.MANY", 0)
    brief = run.ok(line)
    assert "stable motions of" in brief and "contvines show" in brief and "from .. to" not in brief
    assert "from .. to" in run.ok(line + " --details")


def test_an_atlas_goes_on_with_a_larger_budget(run, folder):
    """The file of the small one is not set aside; the result is that of the large one alone."""
    status, out, err = run("atlas a.toml --budget 1")
    assert not status and "left out are" in out and "contvines atlas a.toml --budget 2 goes on" in err
    status, out, err = run("atlas a.toml")
    assert not status and "nothing to compute" not in err and "left out" not in out
    run.ok("atlas a.toml -o alone.vines --quiet")
    assert same_graph(kept("a-atlas.vines"), kept("alone.vines"))
    assert not (folder / "a-atlas.old.vines").exists()


def test_a_sweep_is_drawn_over_the_graph_of_its_machine_alone(run, folder):
    run.ok("sweep sweep.toml --over s.vines --plot o.png -q -o o.csv")
    assert (folder / "o.png").stat().st_size > 10_000
    other = PAPER.replace("0.76", "0.6").replace("amplitude = 0.55", "amplitude = 0.5")
    (folder / "other.toml").write_text(other)
    status, _, said = run("sweep other.toml --over s.vines --plot b.png")
    assert status == 1
    assert (
        "s.vines: this is the graph of another machine: restitution = 0.76 there and 0.6 in the study" in said
    )
    assert "friction" not in said and "amplitude =" not in said
    assert not (folder / "other-sweep.csv").exists()
