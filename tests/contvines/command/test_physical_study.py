"""Studies in kilograms, millimetres and hertz: read, refused, continued and shown."""

import json

import numpy as np
import pytest

from contvines.command.compose import machine
from contvines.command.study import StudyError, check_study
from contvines.command.survey_study import outcomes_of, plan_and_machine

STUDY = """
units = "si"
[model]
name = "coupled"
oscillator_mass = "3.8 kg"
natural_frequency = "8 Hz"
absorber_mass = "32 g"
half_width = "15 mm"
damping_ratio = 0.007
restitution = 0.6
friction = 0.1
base_amplitude = "0.3 mm"
[start]
word = "LR"
frequency = "7.9 Hz"
[continue]
parameter = "frequency"
within = ["7.5 Hz", "8200 mHz"]
depth = 0
[sweep]
count = 3
"""


def nested(**changes):
    """The study as dicts; `model__half_width="x"` changes one value, None takes it out."""
    import tomllib

    data = tomllib.loads(STUDY)
    for key, value in changes.items():
        section, _, field = key.partition("__")
        place = data[section] if field else data
        name = field or section
        if value is None:
            place.pop(name)
        else:
            place[name] = value
    return data


@pytest.mark.parametrize(
    ("survey", "says"),
    [
        ({"vary": {"half_width": ["15mm..25mm"]}}, "[survey] vary.half_width[0] = '15mm..25mm': 'mm..25mm' is no unit of a length"),
        ({"vary": {"half_width": {"within": [8, 20], "count": 2}}}, "[survey] vary.half_width.within[0] = 8 has no unit"),

        ({"vary": {"restitution": {"normal": [0.6, -0.1]}}}, "[survey] vary.restitution.normal[1] = -0.1 is out of range"),

        ({"outcomes": ["first:fould"]}, "'first:fould': there are no points of this kind (did you mean 'fold'?)"),
    ],
)  # fmt: skip
def test_bad_surveys_get_a_sentence(survey, says):
    study = check_study({**nested(), "survey": {"vary": {"restitution": [0.5, 0.6]}, **survey}})
    with pytest.raises(ValueError) as caught:
        plan_and_machine(study)
        outcomes_of(study)
    assert says in str(caught.value)


def test_a_study_is_read():
    study = check_study(nested())
    assert study.within == pytest.approx((7.5, 8.2), rel=1e-15)
    assert study.parameters["half_width"] == 15.0 and study.parameters["frequency"] == 7.9
    model = machine(study)
    assert model.column(model.vector(), "frequency") == pytest.approx(7.9 / 8.0, rel=1e-14)
    moved = check_study(nested(units=None, model__units="si"))
    assert moved.describe() == study.describe() and moved.fingerprint() == study.fingerprint()


def test_a_study_without_a_word_begins_in_the_middle_of_its_interval():
    study = check_study(nested(start=None))
    assert study.word is None and study.parameters["frequency"] == pytest.approx(7.85)
    over = {"continue__parameter": "stiffness", "continue__within": ["9 kN/m", "10 kN/m"]}
    said = check_study(
        nested(**over, start={"frequency": "7.9 Hz"})
    )  # the natural frequency tells the stiffness
    assert said.parameters["stiffness"] == pytest.approx(3.8 * (16 * np.pi) ** 2, rel=1e-13)


def test_a_refused_word_names_the_line_to_delete(tmp_path):
    with pytest.raises(StudyError, match='delete the line word = "LtttR" of \\[start\\]'):
        check_study(nested(start__word="LtttR"))
    from contvines.command.compose import first_orbit

    with pytest.raises(ValueError, match='no orbit .* delete the line word = "LRLRLRLRLR" of'):
        first_orbit(check_study(nested(start__word="LRLRLRLRLR")))


def test_any_quantity_may_vary():
    study = check_study(nested(continue__parameter="stiffness", continue__within=["9 kN/m", "10 kN/m"]))
    assert machine(study).amount_names[3] == "stiffness" or "stiffness" in machine(study).amount_names
    assert study.within == pytest.approx((9000.0, 10000.0))
    assert study.parameters["stiffness"] == pytest.approx(3.8 * (16 * np.pi) ** 2, rel=1e-13)


def test_start_replaces_what_the_model_says_of_the_same_thing():
    study = check_study(nested(start__force_amplitude="3 N"))
    assert "base_amplitude" not in study.parameters and study.parameters["force_amplitude"] == 3.0


@pytest.mark.parametrize(
    ("change", "says"),
    [
        ({"units": "imperial"}, "units = 'imperial' is unknown; use \"si\""),
        ({"model__half_width": "20 m"}, "[model] half_width = '20 m' is implausible"),
        ({"model__half_width": "15 kg"}, "[model] half_width = '15 kg': 'kg' is the unit of a mass"),



        ({"start__frequency": "9 Hz"}, "[start] frequency = 9 Hz lies outside [continue] within = [7.5, 8.2] Hz"),



        ({"continue__parameter": "speed"}, "has no such quantity (did you mean 'frequency'?); it has"),

        ({"model__stiffness": "9 kN/m"}, "natural_frequency and stiffness say the same thing twice"),


        ({"model__oscillator_mass": "3,8 kg"}, "[model] oscillator_mass = '3,8 kg' is not a number with a unit (decimals stand behind a point)"),
        ({"model__oscillator_mass": "-3.8 kg"}, "[model] oscillator_mass = '-3.8 kg' is out of range; give a value above 0, for example \"3.8 kg\""),
        ({"model__natural_frequency": "8 kHz"}, "frequency = 7.9 Hz is 0.000988 times natural_frequency = 8 kHz, which is implausible"),

        ({"model__absorber_mass": "32 kg"}, "absorber_mass = 32 kg is 8.42 times oscillator_mass = 3.8 kg, which is implausible"),

        ({"continue__parameter": "restitution", "continue__within": [0.5, 1.5]}, "[continue] within[1] = 1.5 is out of range; give a number above 0 and at most 1"),
        ({"continue__parameter": "slope", "continue__within": ["1 deg", "90.5 deg"]}, "[continue] within[1] = 90.5 deg is out of range; give a number from -90 to 90 deg"),
    ],
)  # fmt: skip
def test_bad_studies_get_a_sentence(change, says):
    with pytest.raises(StudyError) as caught:
        check_study(nested(**change))
    assert says in str(caught.value)


def test_tables_json_and_csv_speak_the_study_s_units(run, tmp_path):
    (tmp_path / "case.toml").write_text(STUDY)

    assert "frequency [Hz]" in run("diagram", "case.toml")[1]
    about = json.loads(run("show", "case.vines", "--json")[1])
    assert about["units"]["frequency"] == "Hz" and about["units"]["max_abs_q1"] == "mm"
    assert about["within"] == pytest.approx([7.5, 8.2])
    fold = next(p for p in about["special"] if p["kind"] == "fold")
    assert 7.5 < fold["value"]["frequency"] < 8.2
    shown = run("orbit", "case.vines", fold["label"])[1]
    assert "half_width = 15 mm" in shown and "B_pre [mm/s]" in shown
    assert run("export", "case.vines", "--to", "csv")[0] == 0
    head = (tmp_path / "case.csv").read_text().splitlines()[0].split(",")
    assert "frequency [Hz]" in head and "max_abs_q1 [mm]" in head
    assert run("sweep", "case.toml")[0] == 0
    rows = (tmp_path / "case-sweep.csv").read_text().splitlines()
    assert "value [Hz]" in rows[0] and "max_abs_q1 [mm]" in rows[0]
    assert [float(row.split(",")[0]) for row in rows[1:]] == pytest.approx([7.5, 7.85, 8.2])


def test_bounds_are_read_in_their_units():
    """Measures are shown in millimetres, millimetres per second and so on; bounds may be text with any unit of that kind."""
    plain = check_study(nested(continue__bounds={"B": [-np.inf, 150.0]}))
    assert plain.bounds == {"B": (-np.inf, 150.0)}
    unit = machine(plain).units["B"]
    size = {"m/s": 1.0, "mm/s": 1e3, "cm/s": 1e2}[unit]
    told = check_study(nested(continue__bounds={"B": ["2 cm/s", "150 mm/s"]}))
    assert told.bounds["B"] == pytest.approx((0.02 * size, 0.15 * size), rel=1e-14)
