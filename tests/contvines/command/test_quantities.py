"""Studies in kilograms, millimetres and hertz, over conditions and within bounds: read, continued and shown."""

import numpy as np
import pytest

from contvines.command.compose import first_orbit, machine
from contvines.command.recommend import _target
from contvines.command.study import check_study
from contvines.command.survey_study import units_of
from contvines.store import load
from tests.contvines.studies import PAPER, SI, TWO, WARM, data, table


def study(changes="", text=SI):
    return check_study(data(text, changes))


def test_a_study_is_read():
    read = study()
    assert read.within == pytest.approx((7.5, 8.2), rel=1e-15)
    assert read.parameters["half_width"] == 15.0 and read.parameters["frequency"] == 7.9
    model = machine(read)
    assert model.column(model.vector(), "frequency") == pytest.approx(7.9 / 8.0, rel=1e-14)
    assert study('no units\nmodel.units = "si"').fingerprint() == read.fingerprint()
    other = study('start.force_amplitude = "3 N"').parameters  # another word for what shakes
    assert "base_amplitude" not in other and other["force_amplitude"] == 3.0


STIFFNESS = 'continue = { parameter = "stiffness", within = ["9 kN/m", "10 kN/m"] }'


def test_any_quantity_may_vary():
    """The natural frequency tells where the stiffness begins; without a start, a study begins in the middle."""
    assert study("no start").parameters["frequency"] == pytest.approx(7.85)
    read = study(STIFFNESS)
    assert "stiffness" in machine(read).amount_names
    assert read.within == pytest.approx((9000.0, 10000.0))
    assert read.parameters["stiffness"] == pytest.approx(3.8 * (16 * np.pi) ** 2, rel=1e-13)


def test_a_word_that_is_not_there_names_the_line_to_delete():
    with pytest.raises(ValueError, match='no orbit .* delete the line word = "LRLRLRLRLR" of'):
        first_orbit(study('start.word = "LRLRLRLRLR"'))


def test_quantities_of_a_declared_machine_are_numbers_in_its_units():
    read = study(
        'model = { clearance_1 = "1.5 cm", oscillator_mass = "3800 g", friction_1 = 0.2 }\n'
        'continue.within = ["7 Hz", "0.009 kHz"]\ncontinue.bounds.max_q = ["0 mm", "3 cm"]\nsweep.within = ["8 Hz", "540 rpm"]\n'
        'survey.vary = { clearance_1.within = ["6 mm", "0.03 m"], base_amplitude.uniform = ["0.3 mm", "400 um"] }\n'
        'survey.outcomes = ["largest:peak_force", "largest:max_q"]',
        TWO,
    )
    given = {"clearance_1": 15.0, "oscillator_mass": 3.8, "friction_1": 0.2}
    assert read.loose == pytest.approx(read.loose | given)
    assert (read.within, read.sweep.within) == (pytest.approx((7.0, 9.0)), pytest.approx([8.0, 9.0]))
    assert read.bounds["max_q"] == pytest.approx((0.0, 30.0))
    assert read.survey.vary == {
        "clearance_1": {"within": pytest.approx([6.0, 30.0])},
        "base_amplitude": {"uniform": pytest.approx([0.3, 0.4])},
    }
    with pytest.raises(ValueError, match="--target 3 kg: .*max_abs_q is shown in mm"):
        _target("3 kg", read)
    assert _target("3 cm", read) == pytest.approx(30.0)
    wanted = {"largest_peak_force": "N", "largest_max_q": "mm", "largest_max_q_at": "Hz"}
    assert wanted.items() <= units_of(read, read.model).items()
    about = read.describe()["model"]
    assert about["name"] == "coupled_two" and not {"page", "source", "digest"} & set(about)


def test_tables_json_and_csv_speak_the_study_s_units(run, tmp_path):
    (tmp_path / "case.toml").write_text(SI + "[sweep]\ncount = 3\n")
    assert "frequency [Hz]" in run.ok("diagram case.toml")
    about = run.json("show case.vines")
    assert about["units"]["frequency"] == "Hz" and about["units"]["max_abs_q1"] == "mm"
    assert about["within"] == pytest.approx([7.5, 8.2])
    fold = next(p for p in about["special"] if p["kind"] == "fold")
    assert 7.5 < fold["value"]["frequency"] < 8.2
    shown = run.ok("orbit", "case.vines", fold["label"])
    assert "half_width = 15 mm" in shown and "B_pre [mm/s]" in shown
    run.ok("export case.vines --to csv")
    assert {"frequency [Hz]", "max_abs_q1 [mm]"} <= set(table(tmp_path / "case.csv")[0])
    run.ok("sweep case.toml")
    rows = table(tmp_path / "case-sweep.csv")
    assert "max_abs_q1 [mm]" in rows[0]
    assert [float(row["value [Hz]"]) for row in rows] == pytest.approx([7.5, 7.85, 8.2])


# ---------------------------------------------------------------- conditions
def test_a_condition_runs_linearly_between_its_rows():
    assert study(text=WARM).model.restitution == pytest.approx(0.75)
    assert study("conditions.temperature = 70", WARM).model.restitution == pytest.approx(0.65)
    humid = 'conditions.humidity = 0.25\nmodel.half_width = { humidity = [[0, "15 mm"], [1, "1.6 cm"]] }'
    assert study(humid).model.quantities["half_width"] == pytest.approx(15.25)


@pytest.mark.slow
def test_a_survey_over_a_condition_is_one_over_what_follows(run, tmp_path):
    """The same machines with their restitutions given: 0.8 and 0.65."""
    peaks = []
    for text in (WARM, PAPER + "[survey]\nvary.restitution = [0.8, 0.65]\n"):
        (tmp_path / "s.toml").write_text(text.replace("[0.2, 1.2]", "[0.5, 0.7]"))
        run.ok("survey s.toml --workers 1 --quiet --fresh")
        peaks.append([float(row["peak"]) for row in table(tmp_path / "s-survey.csv")])
    assert peaks[0] == pytest.approx(peaks[1], rel=1e-9)
    assert [row["temperature"] for row in table(tmp_path / "s-survey.old.csv")] == ["20.0", "70.0"]


# ---------------------------------------------------------------- bounds
def test_branches_end_where_a_measure_leaves_its_interval(run, tmp_path):
    (tmp_path / "free.toml").write_text(PAPER)
    (tmp_path / "s.toml").write_text(PAPER + "bounds = { B = [-inf, 1.1] }\n")
    for name in ("free", "s"):
        run.ok(f"diagram {name}.toml --quiet --no-look")
    free, graph = load("free.vines")["B1"], load("s.vines")
    assert free.measure("B").max() > 1.2
    assert graph["B1"].measure("B").max() == pytest.approx(1.1, abs=1e-9)
    (stop,) = graph.of_kind("user")
    # where the branch without bounds passes the value
    order = np.argsort(free.measure("B"))
    assert stop.value == pytest.approx(np.interp(1.1, free.measure("B")[order], free.values[order]), abs=1e-3)
    assert graph.settings["bounds"] == {"B": [None, 1.1]}


def test_bounds_are_read_in_their_units():
    """Measures are shown in millimetres, millimetres per second and so on; bounds may be text with any unit of that kind."""
    assert study("continue.bounds.B = [-inf, 150.0]").bounds == {"B": (-np.inf, 150.0)}
    told = study('continue.bounds.B = ["2 cm/s", "0.15 m/s"]')
    assert told.bounds["B"] == pytest.approx((20.0, 150.0), rel=1e-14)  # mm/s
