"""Studies of flows from the command line."""

import json
import math

import pytest

import contvines
from contvines.command.entry import main
from contvines.command.study import StudyError, read_study
from contvines.command.survey_study import family_of

FILE = """
import contvines as cv

oscillator = cv.FlowProblem(
    lambda x, p: [p.m * x[0] - x[1] - x[0] * (x[0] ** 2 + x[1] ** 2), x[0] + p.m * x[1] - x[1] * (x[0] ** 2 + x[1] ** 2)],
    [0.0, 0.0],
    {"m": -0.1},
)
"""
STUDY = """
[model]
name = "flow.py:oscillator"
[continue]
parameter = "m"
within = [-0.2, 0.3]
"""


@pytest.fixture
def study(tmp_path, monkeypatch):
    (tmp_path / "flow.py").write_text(FILE)
    (tmp_path / "study.toml").write_text(STUDY)
    monkeypatch.chdir(tmp_path)
    return tmp_path / "study.toml"


def run(monkeypatch, *words):
    monkeypatch.setattr("sys.argv", ["contvines", *words])
    with pytest.raises(SystemExit) as ended:
        main()
    return ended.value.code


def test_diagram_picture_and_orbit(study, monkeypatch, capsys):
    assert not run(monkeypatch, "diagram", "study.toml", "--plot", "diagram.png", "-y", "period")
    table = capsys.readouterr().out
    assert "HB1" in table
    assert "cycle" in table
    assert (study.parent / "diagram.png").stat().st_size > 1000
    assert not run(monkeypatch, "orbit", "study.vines", "B2:3", "--trust")
    assert "cycle of period 6.283  " in capsys.readouterr().out
    assert not run(monkeypatch, "orbit", "study.vines", "B1:0", "--trust")
    assert capsys.readouterr().out.split("\n")[:4] == [
        "equilibrium  (stable)", "  x0 = 0  x1 = 0", "  m = -0.2", "  eigenvalues: -0.2 + 1i, -0.2 - 1i",
    ]  # fmt: skip
    assert not run(monkeypatch, "orbit", "study.toml", "--json")
    assert json.loads(capsys.readouterr().out)["eigenvalues"] == [
        [pytest.approx(-0.1), 1.0],
        [pytest.approx(-0.1), -1.0],
    ]


def test_what_a_motion_settles_on(study, monkeypatch, capsys):
    study.write_text(STUDY + "\n[start]\nstate = [0.3, 0.0]\nm = 0.25\n")
    assert not run(monkeypatch, "orbit", "study.toml")
    assert "period 6.283  " in capsys.readouterr().out


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (("within = [-0.2, 0.3]", "within = [0.3, -0.2]"), "reversed"),
        (('parameter = "m"', 'parameter = "k"'), "no such parameter"),
        (("[continue]", "[start]\nstate = [1.0]\n[continue]"), "2 states"),
        (("within = [-0.2, 0.3]", "within = [0.2, 0.3]"), "lies outside"),
        (("oscillator", "pendulum"), "no flow 'pendulum'; it has oscillator"),
        (("[continue]", "[start]\nbox = [[-1.0, 1.0]]\n[continue]"), "box has 1 pair"),
        (("[continue]", "[start]\nbox = [[-1.0, 1.0], [2.0, 1.0]]\n[continue]"), "low < high"),
    ],
)
def test_bad_studies_are_refused(study, change, words):
    study.write_text(STUDY.replace(*change))
    with pytest.raises(StudyError, match=words):
        read_study(study)


def test_a_parameter_that_is_called_name_is_refused(study):
    (study.parent / "flow.py").write_text(FILE.replace("p.m", "p.name").replace('"m"', '"name"'))
    study.write_text(STUDY.replace('"m"', '"name"'))
    with pytest.raises(StudyError, match="'name' needs another name"):
        read_study(study)


def test_commands_for_machines_say_so(study, monkeypatch, capsys):
    assert run(monkeypatch, "sweep", "study.toml")
    assert "needs a machine" in " ".join(capsys.readouterr().err.split())


def test_a_chart_of_a_section(study, monkeypatch, capsys):
    """Hopf points at m = c."""
    (study.parent / "flow.py").write_text(
        FILE.replace("p.m", "(p.m - p.c)").replace('{"m": -0.1}', '{"m": -0.1, "c": 0.05}')
    )
    study.write_text(STUDY + '[chart]\nparameter = "c"\nwithin = [0.1, 0.0]\n')
    with pytest.raises(StudyError, match=r"\[chart\] within .* reversed"):
        read_study(study)
    study.write_text(STUDY + '[chart]\nparameter = "c"\nwithin = [0.0, 0.1]\n')
    assert not run(monkeypatch, "chart", "study.toml")
    assert "kept in study-chart.vines" in capsys.readouterr().err
    locus = contvines.load(study.parent / "study-chart.vines").loci["HB1"]
    assert locus.values[:, 0] == pytest.approx(locus.values[:, 1], abs=1e-10)


def test_a_folder_may_be_moved(study, monkeypatch, capsys):
    """Its results find the file of the flow that was moved with them; Hopf point at m = 0, eigenvalues +-i."""
    here, there = study.parent / "here", study.parent / "there"
    here.mkdir()
    for name in ("flow.py", "study.toml"):
        (study.parent / name).rename(here / name)
    monkeypatch.chdir(here)
    assert not run(monkeypatch, "diagram", "study.toml", "-q", "--no-look")
    here.rename(there)
    monkeypatch.chdir(there)
    monkeypatch.setattr("contvines.flows.files._loaded", {})  # as in another process
    orbit = contvines.load("study.vines", trust=True)["HB1"].orbit
    assert orbit.value == pytest.approx(0.0, abs=1e-9) and abs(orbit.eigenvalues.imag) == pytest.approx(
        [1.0, 1.0]
    )
    (there / "flow.py").unlink()
    monkeypatch.setattr("contvines.flows.files._loaded", {})
    with pytest.raises(ValueError, match="put it back, or beside the result"):
        contvines.load("study.vines", trust=True)


def test_simulations_of_a_survey_begin_in_the_box_of_the_study(study):
    study.write_text(STUDY + "[start]\nbox = [[-1.0, 1.0], [0.0, 2.0]]\n")
    read = read_study(study)
    family = family_of(read, read.flow)
    read.flow.box = None  # another process has not read the study
    assert family({}).population("m").box(0.0).tolist() == [[-1.0, 1.0], [0.0, 2.0]]


def test_atlas_and_basins(study, monkeypatch, capsys):
    box = "\n[start]\nbox = [[-1.0, 1.0], [-1.0, 1.0]]\n[atlas]\nvalues = 2\nstarts = 8\nscan = 0\n"
    study.write_text(STUDY + box)
    assert not run(monkeypatch, "atlas", "study.toml", "--plot", "atlas.png")
    table = capsys.readouterr().out
    assert "equilibrium" in table and "cycle" in table and "HB1" in table
    assert (study.parent / "atlas.png").stat().st_size > 1000
    assert not run(
        monkeypatch, "basins", "study.toml", "--at", "0.2", "--points", "5", "--plot", "basins.png"
    )
    assert "100.00%" in capsys.readouterr().out  # every start reaches the circle


def test_what_is_done_with_a_file(study, monkeypatch, capsys):
    assert not run(monkeypatch, "diagram", "study.toml", "-q", "--plot", "diagram.png")
    assert not run(monkeypatch, "switch", "study.vines", "HB1", "--trust")
    assert "B2" in capsys.readouterr().out
    assert not run(monkeypatch, "export", "study.vines", "--to", "csv", "-o", "out.csv", "--trust")
    head = (study.parent / "out.csv").read_text().splitlines()[0].split(",")
    assert {"period", "max x0", "min x1", "multiplier0_re"} <= set(head)
    assert "u2" not in head
    assert not run(monkeypatch, "plot", "study.vines", "-y", "period", "--trust", "-o", "period.png")
    assert not run(monkeypatch, "report", "study.vines", "--trust", "-o", "study.html")


@pytest.mark.slow
def test_a_survey_of_flows(study, monkeypatch, capsys):
    """Cycles of radius sqrt(m / c) and period 2 pi, from m = 0 on."""
    (study.parent / "flow.py").write_text(
        FILE.replace("- x[0] * (x", "- p.c * x[0] * (x")
        .replace("- x[1] * (x", "- p.c * x[1] * (x")
        .replace("-0.1}", '-0.1, "c": 1.0}')
    )
    study.write_text(
        STUDY + '[survey]\nvary = { c = [1.0, 4.0] }\noutcomes = ["peak", "first:hopf", "largest:period"]\n'
    )
    assert run(monkeypatch, "recommend", "study.toml") == 1
    assert "recommend is for machines; contvines survey --best" in capsys.readouterr().err
    assert not run(monkeypatch, "survey", "study.toml", "--workers", "1", "--json")
    rows = json.loads(capsys.readouterr().out)["rows"]
    assert [row["c"] for row in rows] == [1.0, 4.0]
    for row in rows:
        assert row["peak"] == pytest.approx((0.3 / row["c"]) ** 0.5, abs=1e-7)
        assert row["first_hopf"] == pytest.approx(0.0, abs=1e-12)
        assert row["largest_period"] == pytest.approx(2.0 * math.pi, abs=1e-7)
        assert row["covered"] == 1.0
