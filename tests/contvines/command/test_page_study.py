"""Studies whose machine is a file of Python, or a structure of masses and springs."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import contvines as cv
from orbits.machines.page import loading
from tests.contvines.studies import EXAMPLES, STOP, STOP_FILE


@pytest.fixture
def study(run, tmp_path):
    """The file of a study, stop.toml, beside its machine."""
    (tmp_path / "stop.py").write_text(STOP_FILE)
    (tmp_path / "stop.toml").write_text(STOP)
    return tmp_path / "stop.toml"


@pytest.fixture
def elsewhere(monkeypatch):
    """As in another process, which has not run the machine file."""
    return lambda: monkeypatch.setattr(loading, "loaded", lambda settings: None)


def test_a_page_from_study_to_file(run, study):
    run.ok("diagram stop.toml -q")
    graph = cv.load("stop.vines")
    assert graph.model["gap"] == 0.05 and "Machine(" in graph.model["source"]
    assert graph["B1"].description["word"] == "R"
    assert "R  k = 1  (real)" in run.ok("orbit stop.toml")
    run.ok("sweep stop.toml -q --plot s.png")
    rows = (study.parent / "stop-sweep.csv").read_text().splitlines()
    assert len(rows) == 5 and all(",periodic,R,1,1," in row for row in rows[1:])


def test_a_file_runs_no_page_and_says_when_it_has_changed(run, study, elsewhere):
    run.ok("diagram stop.toml -q")
    elsewhere()
    assert cv.load("stop.vines")["B1"].problem is None
    assert cv.load("stop.vines", trust=True)["B1"].problem is not None
    (study.parent / "stop.py").write_text(STOP_FILE + "# another\n")
    assert "the machine file has changed since the result was made" in run("show stop.vines")[2]
    status, _, err = run("orbit stop.vines B1 --trust")
    assert status and "make the result anew" in err and "does not hold" not in err


def test_a_folder_may_be_moved(run, study, elsewhere, monkeypatch):
    """The result stays that of its study, and its orbits come from the machine file that was moved with it."""
    here, there = study.parent / "here", study.parent / "there"
    (here / "files").mkdir(parents=True)
    (study.parent / "stop.py").rename(here / "files" / "stop.py")
    (here / "stop.toml").write_text(STOP.replace("stop.py", "files/stop.py"))
    monkeypatch.chdir(here)
    run.ok("diagram stop.toml -q --no-look")
    before = cv.load("stop.vines", trust=True)["EP1"].orbit
    here.rename(there)
    monkeypatch.chdir(there)
    elsewhere()
    assert "nothing to compute" in run("diagram stop.toml --no-look")[2]
    after = cv.load("stop.vines", trust=True)["EP1"].orbit
    assert (after.multipliers == before.multipliers).all() and after.margin == before.margin
    (there / "files" / "stop.py").unlink()
    assert "put it back, or beside the result" in run("show stop.vines")[2]


@pytest.mark.slow
def test_an_atlas_and_basins_of_a_page(run, study):
    study.write_text(STOP + "[atlas]\nvalues = [2.3]\nstarts = 6\nscan = 0\n")
    run.ok("atlas stop.toml -q -o a.vines")
    met = cv.load("a.vines").attractors
    assert [(a.word, a.kind, a.share) for a in met] == [("R", "periodic", 1.0)]
    found = run.json("basins stop.toml --at 2.3 --points 4")
    assert found["plane"] == ["x", "v"]
    assert {a["kind"] for a in found["attractors"]} == {"periodic", "impossible"}


@pytest.mark.slow
def test_a_survey_of_a_page(run, study):
    """With the wall at zero the machine is as large as its forcing: twice the forcing, twice the speeds, at the same frequencies."""
    vary = '[survey]\nvary = {forcing = [1.0, 2.0, 4.0]}\noutcomes = ["peak", "stable:R"]\ngaps = 0\n'
    study.write_text(STOP.replace("gap = 0.05", "gap = 0.0") + vary)
    rows = run.json("survey stop.toml --workers 1 -q")["rows"]
    assert [row["peak"] / rows[0]["peak"] for row in rows] == pytest.approx([1.0, 2.0, 4.0], rel=1e-6)
    assert [row["stable_R"] for row in rows] == pytest.approx([rows[0]["stable_R"]] * 3, rel=1e-9)


def struck(restitution, count, forcing=1.0, frequency=2.3, damping=0.05, gap=0.05):
    """Instants of the stop's impacts from rest, by DOP853 with an event."""

    def rates(t, s):
        return [s[1], forcing * np.cos(frequency * t) - 2 * damping * s[1] - s[0]]

    def hit(t, s):
        return gap - s[0]

    hit.terminal, hit.direction = True, -1
    times, t, s = [], 0.0, [0.0, 0.0]
    while len(times) < count:
        run = solve_ivp(rates, (t, t + 100.0), s, "DOP853", events=hit, rtol=1e-11, atol=1e-12)
        t, s = run.t[-1], [gap - 1e-15, -restitution * run.y[1, -1]]
        times.append(t)
    return times


@pytest.mark.slow
def test_a_page_is_calibrated(run, study):
    hits = "\n".join(str(t) for t in struck(0.66, 8))
    (study.parent / "hits.csv").write_text("time\n" + hits)
    found = run.json("calibrate stop.toml --impacts hits.csv --limits restitution=0.4,0.9")
    assert found["values"]["restitution"] == pytest.approx(0.66, abs=1e-6)


@pytest.mark.slow
def test_the_grazes_of_two_masses_are_borders(run, tmp_path):
    """NLvib's two masses: |receptance x1 of a force on 2| times 0.1 is 1."""
    (tmp_path / "two.toml").write_text((EXAMPLES / "structures" / "two_masses.toml").read_text())
    run.ok("diagram two.toml")
    graph = cv.load("two.vines")  # without running anything
    values = sorted(float(point.value) for point in graph.of_kind("switch-graze"))
    np.testing.assert_allclose(values, (0.5818996390393119, 0.6534401404162605), rtol=1e-12)
    assert all(branch.problem is not None for branch in graph.branches.values())
