"""Studies of flows from the command line."""

import json
import math

import pytest

import contvines
from contvines.command.study import StudyError, read_study
from contvines.command.survey_study import family_of

FILE = """
import contvines as cv

def rates(x, mu, c=1.0):
    growth = mu - c * (x[0] ** 2 + x[1] ** 2)
    return [growth * x[0] - x[1], x[0] + growth * x[1]]

oscillator = cv.FlowProblem(lambda x, p: rates(x, p.mu), [0.0, 0.0], {"mu": -0.1})
"""
STUDY = """
[model]
name = "flow.py:oscillator"
[continue]
parameter = "mu"
within = [-0.2, 0.3]
"""


@pytest.fixture
def study(tmp_path, monkeypatch):
    (tmp_path / "flow.py").write_text(FILE)
    (tmp_path / "study.toml").write_text(STUDY)
    monkeypatch.chdir(tmp_path)
    return tmp_path / "study.toml"


@pytest.fixture
def done(run):
    """Runs `contvines ...`, which must not fail; returns what it says."""

    def go(*words):
        status, out, err = run(*words)
        assert not status, err
        return out

    return go


def test_diagram_picture_and_orbit(study, done):
    table = done("diagram", "study.toml", "--plot", "diagram.png", "-y", "period")
    assert "HB1" in table and "cycle" in table
    assert (study.parent / "diagram.png").stat().st_size > 1000
    assert "cycle of period 6.283  " in done("orbit", "study.vines", "B2:3", "--trust")
    assert done("orbit", "study.vines", "B1:0", "--trust").split("\n")[:4] == [
        "equilibrium  (stable)", "  x0 = 0  x1 = 0", "  mu = -0.2", "  eigenvalues: -0.2 + 1i, -0.2 - 1i",
    ]  # fmt: skip
    assert json.loads(done("orbit", "study.toml", "--json"))["eigenvalues"] == [
        [pytest.approx(-0.1), 1.0],
        [pytest.approx(-0.1), -1.0],
    ]
    assert "B2" in done("switch", "study.vines", "HB1", "--trust")
    done("export", "study.vines", "--to", "csv", "-o", "out.csv", "--trust")
    head = (study.parent / "out.csv").read_text().splitlines()[0].split(",")
    assert {"period", "max x0", "min x1", "multiplier0_re"} <= set(head) and "u2" not in head
    done("plot", "study.vines", "-y", "period", "--trust", "-o", "period.png")
    done("report", "study.vines", "--trust", "-o", "study.html")


def test_what_a_motion_settles_on(study, done):
    study.write_text(STUDY + "\n[start]\nstate = [0.3, 0.0]\nmu = 0.25\n")
    assert "period 6.283  " in done("orbit", "study.toml")


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (("within = [-0.2, 0.3]", "within = [0.3, -0.2]"), "reversed"),
        (('parameter = "mu"', 'parameter = "k"'), "no such parameter"),
        (("[continue]", "[start]\nstate = [1.0]\n[continue]"), "2 states"),
        (("within = [-0.2, 0.3]", "within = [0.2, 0.3]"), "lies outside"),
        (("oscillator", "pendulum"), "no flow 'pendulum'; it has oscillator"),
        (("[continue]", "[start]\nbox = [[-1.0, 1.0]]\n[continue]"), "box has 1 pair"),
        (("[continue]", "[start]\nbox = [[-1.0, 1.0], [2.0, 1.0]]\n[continue]"), "lower end first"),
    ],
)
def test_bad_studies_are_refused(study, change, words):
    study.write_text(STUDY.replace(*change))
    with pytest.raises(StudyError, match=words):
        read_study(study)


def test_a_parameter_that_is_called_name_is_refused(study):
    (study.parent / "flow.py").write_text(FILE.replace("p.mu", "p.name").replace('"mu"', '"name"'))
    study.write_text(STUDY.replace('"mu"', '"name"'))
    with pytest.raises(StudyError, match="'name' needs another name"):
        read_study(study)


def test_commands_for_machines_say_so(study, run):
    for line in ("sweep study.toml", "recommend study.toml --target 3"):
        status, _, err = run(line)
        assert status and "needs a machine" in err


def test_a_chart_of_a_section(study, run):
    """Hopf points at mu = c."""
    shifted = FILE.replace("p.mu", "p.mu - p.c").replace("-0.1}", '-0.1, "c": 0.05}')
    (study.parent / "flow.py").write_text(shifted)
    chart = '[chart]\nparameter = "c"\nwithin = '
    study.write_text(STUDY + chart + "[0.1, 0.0]\n")
    with pytest.raises(StudyError, match=r"\[chart\] within .* reversed"):
        read_study(study)
    study.write_text(STUDY + chart + "[0.0, 0.1]\n")
    assert "kept in study-chart.vines" in run("chart", "study.toml")[2]
    locus = contvines.load(study.parent / "study-chart.vines").loci["HB1"]
    assert locus.values[:, 0] == pytest.approx(locus.values[:, 1], abs=1e-10)


def test_a_folder_may_be_moved(study, done, monkeypatch):
    """Its results find the file of the flow that was moved with them; Hopf point at mu = 0, eigenvalues +-i."""
    here, there = study.parent / "here", study.parent / "there"
    here.mkdir()
    for name in ("flow.py", "study.toml"):
        (study.parent / name).rename(here / name)
    monkeypatch.chdir(here)
    done("diagram", "study.toml", "-q", "--no-look")
    here.rename(there)
    monkeypatch.chdir(there)
    monkeypatch.setattr("contvines.flows.files._loaded", {})  # as in another process
    orbit = contvines.load("study.vines", trust=True)["HB1"].orbit
    assert orbit.value == pytest.approx(0.0, abs=1e-9)
    assert abs(orbit.eigenvalues.imag) == pytest.approx([1.0, 1.0])
    (there / "flow.py").unlink()
    monkeypatch.setattr("contvines.flows.files._loaded", {})
    with pytest.raises(ValueError, match="put it back, or beside the result"):
        contvines.load("study.vines", trust=True)


def test_simulations_of_a_survey_begin_in_the_box_of_the_study(study):
    study.write_text(STUDY + "[start]\nbox = [[-1.0, 1.0], [0.0, 2.0]]\n")
    read = read_study(study)
    family = family_of(read, read.flow)
    read.flow.box = None  # another process has not read the study
    assert family({}).population("mu").box(0.0).tolist() == [[-1.0, 1.0], [0.0, 2.0]]


def test_atlas_and_basins(study, done):
    box = "\n[start]\nbox = [[-1.0, 1.0], [-1.0, 1.0]]\n[atlas]\nvalues = 2\nstarts = 8\nscan = 0\n"
    study.write_text(STUDY + box)
    table = done("atlas", "study.toml", "--plot", "atlas.png")
    assert "equilibrium" in table and "cycle" in table and "HB1" in table
    assert (study.parent / "atlas.png").stat().st_size > 1000
    found = done("basins", "study.toml", "--at", "0.2", "--points", "5", "--plot", "basins.png")
    assert "100.00%" in found  # every start reaches the circle


@pytest.mark.slow
def test_a_survey_of_flows(study, run, done):
    """Cycles of radius sqrt(mu / c) and period 2 pi, from mu = 0 on."""
    scaled = FILE.replace("p.mu", "p.mu, p.c").replace("-0.1}", '-0.1, "c": 1.0}')
    (study.parent / "flow.py").write_text(scaled)
    study.write_text(
        STUDY + '[survey]\nvary = { c = [1.0, 4.0] }\noutcomes = ["peak", "first:hopf", "largest:period"]\n'
    )
    status, _, err = run("recommend", "study.toml")
    assert status == 1 and "recommend is for machines; contvines survey --best" in err
    rows = json.loads(done("survey", "study.toml", "--workers", "1", "--json"))["rows"]
    assert [row["c"] for row in rows] == [1.0, 4.0]
    for row in rows:
        assert row["peak"] == pytest.approx((0.3 / row["c"]) ** 0.5, abs=1e-7)
        assert row["first_hopf"] == pytest.approx(0.0, abs=1e-12)
        assert row["largest_period"] == pytest.approx(2.0 * math.pi, abs=1e-7)
        assert row["covered"] == 1.0
