"""Parameters over a condition: linear between the rows by hand, surveys over it, refusals."""

import csv

import pytest

from contvines.command.study import StudyError, study_of

STUDY = """
[model]
name = "absorber"
restitution = { temperature = [[20, 0.8], [60, 0.7], [80, 0.6]] }
friction = 0.5
gravity = 0.211
mass_ratio = 0.006
[conditions]
temperature = 40
[start]
word = "LR"
amplitude = 0.6
[continue]
parameter = "amplitude"
within = [0.5, 0.7]
depth = 0
[survey]
vary.temperature = [20, 70]
"""
SI = """
units = "si"
[model]
name = "coupled"
oscillator_mass = "3.8 kg"
absorber_mass = "32 g"
half_width = { humidity = [[0, "15 mm"], [1, "1.6 cm"]] }
natural_frequency = "8 Hz"
damping_ratio = 0.01
restitution = 0.6
friction = 0.1
base_amplitude = "0.3 mm"
[conditions]
humidity = 0.25
[start]
frequency = "8 Hz"
[continue]
parameter = "frequency"
within = ["7.9 Hz", "8.1 Hz"]
"""


def read(text, tmp_path):
    return study_of(text, tmp_path / "s.toml")


def test_it_runs_linearly_between_the_rows(tmp_path):
    assert read(STUDY, tmp_path).model.restitution == pytest.approx(0.75)
    assert read(STUDY.replace("= 40", "= 70"), tmp_path).model.restitution == pytest.approx(0.65)
    assert read(SI, tmp_path).model.quantities["half_width"] == pytest.approx(15.25)


def test_another_condition_is_another_study(tmp_path):
    one, two = read(STUDY, tmp_path), read(STUDY.replace("= 40", "= 20"), tmp_path)
    assert one.fingerprint() != two.fingerprint()


def test_a_survey_over_it_is_one_over_what_follows(run, tmp_path):
    """The same machines with their restitutions given: 0.8 and 0.65."""
    (tmp_path / "over.toml").write_text(STUDY)
    plain = STUDY.replace("{ temperature = [[20, 0.8], [60, 0.7], [80, 0.6]] }", "0.75")
    plain = plain.replace("[conditions]\ntemperature = 40\n", "").replace(
        "vary.temperature = [20, 70]", "vary.restitution = [0.8, 0.65]"
    )
    (tmp_path / "plain.toml").write_text(plain)
    rows = []
    for name in ("over", "plain"):
        done = run("survey", tmp_path / f"{name}.toml", "--quiet")
        assert done[0] == 0, done[2]
        with (tmp_path / f"{name}-survey.csv").open() as file:
            rows.append(list(csv.DictReader(file)))
    assert [float(row["temperature"]) for row in rows[0]] == [20.0, 70.0]
    for one, two in zip(*rows):
        assert float(one["peak"]) == pytest.approx(float(two["peak"]), rel=1e-9)


@pytest.mark.parametrize(
    ("before", "after", "says"),
    [
        (
            "temperature = 40",
            "temperature = 90",
            "lies outside the table of restitution, which goes from 20 to 80",
        ),
        ("temperature = 40", "temprature = 40", "which has no value .did you mean 'temprature'"),
        ("temperature = 40", "temperature = 40\nhumidity = 1", "nothing depends on it"),
        ("temperature = 40", 'temperature = "warm"', "is no finite number"),
        ("[conditions]\ntemperature = 40\n", "", r"for example \[conditions\] temperature = 20"),
        ("[60, 0.7]", "[10, 0.7]", "ascending"),
        ("[60, 0.7]", "[60]", "a table over one condition"),
        ("[60, 0.7]", "[60, 1.7]", None),
        ('parameter = "amplitude"', 'parameter = "restitution"', "depends on temperature"),
    ],
)
def test_what_cannot_be_is_refused(tmp_path, before, after, says):
    text = STUDY.replace(before, after)
    if says is None:  # a value between two rows that no wall has
        text, says = text.replace("temperature = 40", "temperature = 60"), "restitution = 1.7"
    with pytest.raises(StudyError, match=says):
        read(text, tmp_path)


def test_a_survey_stays_within_the_table(run, tmp_path):
    (tmp_path / "s.toml").write_text(STUDY.replace("[20, 70]", "[20, 90]"))
    assert "lies outside the table" in run("survey", tmp_path / "s.toml")[2]
    (tmp_path / "s.toml").write_text(STUDY + "vary.restitution = [0.5, 0.6]\n")
    assert "depends on temperature; vary temperature" in run("survey", tmp_path / "s.toml")[2]
