"""Studies whose machine is a page of Python."""

import json
import re

import numpy as np
import pytest
from typer.testing import CliRunner

import contvines as cv
from contvines.command.cli import app
from contvines.command.recommend import _target
from contvines.command.recommending import recommend
from contvines.command.study import StudyError, check_study, read_study
from contvines.command.survey_study import plan_and_machine

PAGE = """
from orbits import Machine, Wall
from orbits.symbols import cos

machine = Machine(
    name="stop",
    states=("x", "v"),
    parameters={"forcing": 1.0, "frequency": 2.3, "damping": 0.05, "gap": 0.1, "restitution": 0.8},
    phase_rate="frequency",
    motion=lambda s, phase, p, contact: (s.v, p.forcing * cos(phase) - 2 * p.damping * s.v - s.x),
    contacts=[Wall("R", gap=lambda s, phase, p: p.gap - s.x, push={"v": -1.0}, restitution="restitution")],
)
"""
STUDY = """
[model]
name = "stop.py:machine"
gap = 0.05
[start]
frequency = 2.3
[continue]
parameter = "frequency"
within = [2.2, 2.5]
depth = 0
[sweep]
count = 4
transient = 30
"""


@pytest.fixture
def study(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "stop.py").write_text(PAGE)
    (tmp_path / "stop.toml").write_text(STUDY)
    return tmp_path / "stop.toml"


def run(*words):
    return CliRunner().invoke(app, [str(word) for word in words])


def test_a_page_from_study_to_file(study):
    assert run("diagram", study, "-q").exit_code == 0
    graph = cv.load("stop.vines")
    assert graph.model["gap"] == 0.05 and "Machine(" in graph.model["source"]
    assert graph["B1"].description["word"] == "R"
    assert "R  k = 1  (real)" in run("orbit", study).stdout
    assert run("sweep", study, "-q", "--plot", "s.png").exit_code == 0
    rows = (study.parent / "stop-sweep.csv").read_text().splitlines()
    assert len(rows) == 5 and all(",periodic,R,1,1," in row for row in rows[1:])


REFUSED = {
    'name = "stop.py"': 'names a file but no machine in it; for example "stop.py:machine"',
    'name = "stop.py:other"': "it has no machine 'other'; it declares machine",
    'name = "stop.py:cos"': "cos is a function; an orbits.Machine or a contvines.FlowProblem is expected",
    'name = "none.py:machine"': "there is no such file",
    'name = "../elsewhere/stop.py:machine"': "a study runs Python files of its own folder (or of folders in it) only",
    'name = "/elsewhere/stop.py:machine"': 'for example "stop.py"',
    'name = "stop.py:machine"\nmass = 1.0': "[model] mass = 1.0: there is no such field; known are ",
    'name = "stop.py:machine"\ndamping = "much"': "[model] damping = 'much' is not a number",
    'name = "stop.py:machine"\nrestitution = 2.0': "the restitution of wall 'R' is above 0 and at most 1",
}


@pytest.mark.parametrize("line", REFUSED)
def test_refusals(study, line):
    study.write_text(STUDY.replace('name = "stop.py:machine"', line))
    with pytest.raises(StudyError) as refused:
        read_study(study)
    assert REFUSED[line] in str(refused.value)


TWO = """
units = "si"
[model]
name = "coupled_two"
MODEL
[continue]
parameter = "frequency"
within = ["7.5 Hz", "8.5 Hz"]
[survey]
vary.clearance_2 = ["8 mm", "10 mm"]
"""
IMPOSSIBLE = {
    ("MODEL", 'clearance_1 = "-15 mm"'): "[model] clearance_1 = -15 mm is out of range: walls 'L1' and 'R1' leave no room",
    ("MODEL", 'oscillator_mass = "0 kg"'): "[model] oscillator_mass = 0 kg is out of range: the mass that moves with q_rate",
    ('"frequency"\nwithin = ["7.5 Hz", "8.5 Hz"]', '"friction_1"\nwithin = [-0.1, 0.5]'): "[continue] within = [-0.1, 0.5]: friction_1 = -0.1 is out of",
    ('["8 mm"', '["-8 mm"'): "[survey] vary.clearance_2: clearance_2 = -8 mm is out of range: walls 'L2' and 'R2'",
}  # fmt: skip


def test_a_machine_that_comes_with_the_package_is_known_by_its_name(study):
    study.write_text(TWO.replace("MODEL", ""))
    about = read_study(study).describe()["model"]
    assert about["name"] == "coupled_two" and not {"page", "source", "digest"} & set(about)


@pytest.mark.parametrize("change", IMPOSSIBLE)
def test_values_that_no_machine_has_are_refused_where_they_stand(study, change):
    study.write_text(TWO.replace(*change).replace("MODEL", ""))
    with pytest.raises(ValueError) as refused:
        plan_and_machine(read_study(study))
    assert IMPOSSIBLE[change] in str(refused.value)


def test_a_file_runs_no_page_and_says_when_it_has_changed(study, monkeypatch):
    run("diagram", study, "-q")
    from orbits.machines.page import loading

    monkeypatch.setattr(loading, "loaded", lambda settings: None)  # as in another process
    assert cv.load("stop.vines")["B1"].problem is None
    assert cv.load("stop.vines", trust=True)["B1"].problem is not None
    (study.parent / "stop.py").write_text(PAGE + "# another\n")
    assert "the machine file has changed since the result was made" in run("show", "stop.vines").output
    done = run("orbit", "stop.vines", "B1", "--trust")
    assert done.exit_code != 0 and "make the result anew" in str(done.exception)
    assert "does not hold" not in str(done.exception)


def test_a_folder_may_be_moved(study, monkeypatch):
    """The result stays that of its study, and its orbits come from the machine file that was moved with it."""
    from orbits.machines.page import loading

    here, there = study.parent / "here", study.parent / "there"
    (here / "files").mkdir(parents=True)
    (study.parent / "stop.py").rename(here / "files" / "stop.py")
    (here / "stop.toml").write_text(STUDY.replace("stop.py", "files/stop.py"))
    monkeypatch.chdir(here)
    run("diagram", "stop.toml", "-q", "--no-look")
    before = cv.load("stop.vines", trust=True)["EP1"].orbit
    here.rename(there)
    monkeypatch.chdir(there)
    monkeypatch.setattr(loading, "loaded", lambda settings: None)  # as in another process
    assert "nothing to compute" in run("diagram", "stop.toml", "--no-look").output
    after = cv.load("stop.vines", trust=True)["EP1"].orbit
    assert (after.multipliers == before.multipliers).all() and after.margin == before.margin
    (there / "files" / "stop.py").unlink()
    assert "put it back, or beside the result" in run("show", "stop.vines").output


@pytest.mark.slow
def test_an_atlas_and_basins_of_a_page(study):
    study.write_text(study.read_text() + "[atlas]\nvalues = [2.3]\nstarts = 6\nscan = 0\n")
    done = run("atlas", study, "-q", "-o", "a.vines")
    assert done.exit_code == 0, done.output
    met = cv.load("a.vines").attractors
    assert [(a.word, a.kind, a.share) for a in met] == [("R", "periodic", 1.0)]
    done = run("basins", study, "--at", "2.3", "--points", "4", "--json")
    assert done.exit_code == 0, done.output
    found = json.loads(done.stdout)
    assert found["plane"] == ["x", "v"] and {a["kind"] for a in found["attractors"]} == {
        "periodic",
        "impossible",
    }


@pytest.mark.slow
def test_a_survey_of_a_page(study):
    """With the wall at zero the machine is as large as its forcing: twice the forcing, twice the speeds, at the same frequencies."""
    vary = '[survey]\nvary = {forcing = [1.0, 2.0, 4.0]}\noutcomes = ["peak", "stable:R"]\ngaps = 0\n'
    study.write_text(STUDY.replace("gap = 0.05", "gap = 0.0") + vary)
    done = run("survey", study, "--json", "--workers", "1", "-q")
    assert done.exit_code == 0, done.output
    rows = json.loads(done.stdout)["rows"]
    assert [row["peak"] / rows[0]["peak"] for row in rows] == pytest.approx([1.0, 2.0, 4.0], rel=1e-6)
    assert [row["stable_R"] for row in rows] == pytest.approx([rows[0]["stable_R"]] * 3, rel=1e-9)
    study.write_text(study.read_text().replace('"stable:R"', '"dissipation"'))
    assert (
        "'dissipation' is known for the built-in machines (dissipation also by a declared machine with energy=)"
        in str(run("survey", study).exception)
    )
    for file in ("../own.py", "/own.py"):
        study.write_text(study.read_text().replace('"dissipation"', f'"{file}:tall"'))
        refused = str(run("survey", study).exception)
        study.write_text(study.read_text().replace(f'"{file}:tall"', '"dissipation"'))
        assert "a study runs Python files of its own folder" in refused
    study.write_text(study.read_text().replace("forcing = [1", "mass = [1"))
    assert "has no such parameter; it has forcing, frequency" in str(run("survey", study).exception)


def test_commands_that_know_the_built_in_machines_alone(study):
    for command, why in (
        ("design", "closed forms of the built-in absorbers"),
        ("prove", "offers no proofs"),
    ):
        done = run(command, study)
        assert done.exit_code == 1 and why in str(done.exception)


def struck(restitution, count, forcing=1.0, frequency=2.3, damping=0.05, gap=0.05):
    """Instants of the stop's impacts from rest, by DOP853 with an event."""
    from scipy.integrate import solve_ivp

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
def test_a_page_is_calibrated(study):
    (study.parent / "hits.csv").write_text(
        "time\n" + "".join(f"{t!r}\n" for t in map(float, struck(0.66, 8)))
    )
    done = run("calibrate", study, "--impacts", "hits.csv", "--limits", "restitution=0.4,0.9", "--json")
    assert done.exit_code == 0, done.exception
    assert json.loads(done.stdout)["values"]["restitution"] == pytest.approx(0.66, abs=1e-6)
    refused = run("calibrate", study, "--impacts", "hits.csv", "--release", "1")
    assert "a declared machine says where its motions begin" in str(refused.exception)


QUANTITIES = {
    "units": "si",
    "model": {"name": "coupled_two", "clearance_1": "1.5 cm", "oscillator_mass": "3800 g", "friction_1": 0.2},
    "continue": {"parameter": "frequency", "within": ["7 Hz", "0.009 kHz"]},
    "survey": {
        "vary": {
            "clearance_1": {"within": ["6 mm", "0.03 m"]},
            "base_amplitude": {"uniform": ["0.3 mm", "400 um"]},
        }
    },
}


def test_quantities_of_a_page_that_has_units_are_numbers_in_these():
    study = check_study(QUANTITIES)
    assert study.loose["clearance_1"] == pytest.approx(15.0) and study.loose[
        "oscillator_mass"
    ] == pytest.approx(3.8)
    assert study.within == pytest.approx((7.0, 9.0)) and study.loose["friction_1"] == 0.2
    vary = study.survey.vary
    assert vary["clearance_1"] == {"within": pytest.approx([6.0, 30.0])}
    assert vary["base_amplitude"] == {"uniform": pytest.approx([0.3, 0.4])}
    with pytest.raises(
        ValueError,
        match=r"vary.clearance_1 without count is uncertain; for example vary.clearance_1 = \{ within = \[6.0, 30.0\], count",
    ):
        recommend(study, workers=1)
    with pytest.raises(ValueError, match="--target 3 kg: .*max_abs_q is shown in mm"):
        _target("3 kg", study)
    assert _target("3 cm", study) == pytest.approx(30.0)


@pytest.mark.parametrize(
    ("section", "said", "sentence"),
    [
        ("model", {"name": "coupled_two", "clearance_1": "15 kg"}, "[model] clearance_1 = '15 kg': clearance_1 is shown in mm; for example"),
        ("continue", {"parameter": "frequency", "within": ["7 Hz", "9 m"]}, "[continue] within: frequency = '9 m': frequency is shown in Hz"),
        ("survey", {"vary": {"clearance_1": {"within": ["6 mm", "wide"]}}}, "[survey] vary.clearance_1 = 'wide' is not a number with a unit"),
    ],
)  # fmt: skip
def test_quantities_of_another_kind_are_refused(section, said, sentence):
    with pytest.raises(StudyError, match=re.escape(sentence)):
        check_study({**QUANTITIES, section: said})


@pytest.mark.parametrize(
    ("said", "says"),
    [("imperial", "units = 'imperial' is unknown; use \"si\""), ("si", "the machine 'bare' gives no units")],
)
def test_units_of_a_study_are_those_of_its_machine(tmp_path, said, says):
    (tmp_path / "bare.py").write_text(
        "from orbits import Machine\n"
        "machine = Machine(name='bare', states=('x', 'v'), parameters={'rate': 1.0}, phase_rate='rate',\n"
        "    motion=lambda s, phase, p, c: (s.v, -s.x - s.v))\n"
    )
    data = {
        "units": said, "model": {"name": "bare.py:machine"}, "continue": {"parameter": "rate", "within": [0.5, 2.0]},
    }  # fmt: skip
    with pytest.raises(ValueError, match=re.escape(says)):
        check_study(data, tmp_path / "study.toml")
