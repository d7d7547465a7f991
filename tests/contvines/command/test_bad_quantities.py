"""Quantities as a hurried engineer gives them: each refusal is a sentence that names the field, the value and a way out."""

from pathlib import Path

import pytest

STUDY = (
    (Path(__file__).parents[3] / "examples/design/absorber.toml")
    .read_text()
    .replace("samples = 6", "samples = 1")
)
BASE, HALF, WITHIN = 'base_amplitude = "0.3 mm"', 'half_width = "14 mm"', '["7 Hz", "9 Hz"]'
GRID = 'vary.half_width = { within = ["8 mm", "20 mm"], count = 7 }'
SOUND = "time [ms]\n0\n70\n131\n190\n260\n"


def said(run, folder, change, verb, *words):
    """What a command says of the study with one text in the place of another."""
    old, new = change
    assert old in STUDY
    path = folder / "study.toml"
    path.write_text(STUDY.replace(old, new, 1))
    status, _, error = run(verb, path, *words)
    assert status
    return error.replace("\n", " ")


@pytest.mark.parametrize(
    "zero",
    [
        'base_amplitude = "0 mm"',
        "base_amplitude = 0",
        'force_amplitude = "0 N"',
        'base_acceleration = "0 m/s^2"',
    ],
)
def test_what_nothing_shakes_is_refused(run, tmp_path, zero):
    name, _, rest = zero.partition(" = ")
    unit = {"base_amplitude": "mm", "force_amplitude": "N", "base_acceleration": "m/s^2"}[name]
    text = said(run, tmp_path, (BASE, zero), "diagram", "--no-look")
    assert f"{name} = 0 {unit}: nothing shakes the machine, whatever frequency is; {name} = " in text


@pytest.mark.parametrize(
    ("verb", "words"),
    [("survey", []), ("sweep", []), ("atlas", []), ("trace", []), ("calibrate", ["--impacts", "hits.csv"])],
)
def test_every_command_that_shakes_says_so(run, tmp_path, monkeypatch, verb, words):
    monkeypatch.chdir(tmp_path)
    Path("hits.csv").write_text(SOUND)
    assert "base_amplitude = 0 mm: nothing shakes" in said(
        run, tmp_path, (BASE, 'base_amplitude = "0 mm"'), verb, *words
    )


def test_an_impact_motion_does_not_begin_where_nothing_shakes(run, tmp_path):
    change = (
        f'parameter = "frequency"\nwithin = {WITHIN}',
        'parameter = "base_amplitude"\nwithin = ["0 mm", "1 mm"]',
    )
    (tmp_path / "s.toml").write_text(STUDY.replace(*change).replace(BASE, 'base_amplitude = "0 mm"'))
    error = run("diagram", tmp_path / "s.toml", "--no-look")[2]
    assert "base_amplitude = 0 mm: nothing shakes the machine, so no motion with the word 'LR' lasts" in error
    assert 'base_amplitude = "0.3 mm" would do' in error


def test_a_free_decay_needs_no_shaking(run, tmp_path):
    (tmp_path / "s.toml").write_text(STUDY.replace(BASE, 'base_amplitude = "0 mm"'))
    assert run("transient", tmp_path / "s.toml", "--release", "12 mm")[0] == 0


@pytest.mark.parametrize(
    ("change", "says"),
    [
        ((HALF, 'half_width = "10 mm - 15 mm"'), "half_width = '10 mm - 15 mm'"),
        ((HALF, 'half_width = "10..15 mm"'), "vary.half_width = { uniform = [from, to] }"),
        ((HALF, 'half_width = ["14 mm", "15 mm"]'), "vary.half_width = { uniform = [from, to] }"),
        (("restitution = 0.6", 'restitution = "0.6 +- 0.1"'), "vary.restitution = { uniform = [from, to] }"),
        (("restitution = 0.6", 'restitution = "0.6 ± 0.1"'), "restitution = '0.6 ± 0.1' is not a number"),
        ((HALF, 'clearance = "14 mm"'), "clearance = '14 mm': there is no such quantity (did you mean 'half_width'?)"),
        ((HALF, 'half_width = "0.3 mm"\nbase_amplitude = "14 mm"', ), "base_amplitude = 14 mm is 46.7 times half_width = 0.3 mm"),
        ((BASE, 'base_acceleration = "0.08 g"'), "(did you mean 'g_0'?)"),
        (('"3.8 kg"', '"37 N"'), "'N' is the unit of a force, but oscillator_mass is a mass"),
        (('"coupled"', '"couple"'), "model name = 'couple' is unknown (did you mean 'coupled'?)"),
        ((WITHIN, '["7 mHz", "9 Hz"]'), "[continue] within[0] = '7 mHz': frequency = 0.007 Hz is 0.000875 times natural_frequency = 8.0 Hz"),
    ],
)  # fmt: skip
def test_quantities_of_a_study(run, tmp_path, change, says):
    if "base_amplitude" in change[1]:
        change = (
            f"{HALF}{STUDY.split(HALF)[1].split(BASE)[0]}{BASE}",
            change[1] + "\nrestitution = 0.6\nfriction = 0.1",
        )
    assert says in said(run, tmp_path, change, "diagram", "--no-look")


@pytest.mark.parametrize(
    ("change", "words", "says"),
    [
        ((GRID, 'vary.absorber_mass = ["32 g", "32 kg"]'), [], "vary.absorber_mass[1] = '32 kg': absorber_mass = 32000.0 g is 8.42 times oscillator_mass"),
        ((GRID, 'vary.clearance = ["14 mm"]'), [], "vary.clearance: the model 'coupled' has no such parameter (did you mean 'half_width'?)"),
        ((GRID, 'vary.half_width = "8 mm +- 1 mm"'), [], "what is uncertain has uniform = [from, to]"),
        ((GRID, GRID), ["--workers", "0"], "--workers 0: give a number 1 or above"),
    ],
)  # fmt: skip
def test_surveys(run, tmp_path, change, words, says):
    assert says in said(run, tmp_path, change, "survey", *words)


@pytest.mark.parametrize(
    ("words", "says"),
    [
        (["--release", "5e9 mm"], "--release 5e9 mm is implausible for an oscillator: at most 10 m would do"),
        (["--release", "5,5 mm"], "(decimals stand behind a point); \"5 mm\" would do"),
        (["--record", "shock.csv", "--tail", "2e9 s"], "--tail 2e9 s: give at most 1.99e+03 s"),  # 1e5/(2 pi 8 Hz)
        (["--record", "hard.csv"], "hard.csv: the largest acceleration is 1.96e+06 m/s^2, which is implausible"),  # 2e5 times 9.80665
    ],
)  # fmt: skip
def test_transients(run, tmp_path, monkeypatch, words, says):
    monkeypatch.chdir(tmp_path)
    for name, size in (("shock", 2), ("hard", 2e5)):
        Path(f"{name}.csv").write_text(f"time [s],acceleration [g]\n0,0\n0.01,{size}\n0.02,0\n")
    assert says in said(run, tmp_path, (HALF, HALF), "transient", *words)


@pytest.mark.parametrize(
    ("words", "data", "says"),
    [
        (["--sweep"], "frequency [Hz],response [mm]\n7,5,3,1\n", "row 2 has 4 cells below 2 heads; decimal commas need semicolons"),
        (["--sweep"], "frequency [Hz],response [mm]\n7.5,3\n-7.6,4\n7.7,5\n", "data.csv: frequency of measurement 2 = '-7.6 Hz' is out of range"),
        (["--limits", "restitution=-1,2", "--impacts"], SOUND, "--limits restitution=-1,2: restitution = -1 is out of range"),
        (["--limits", "half_width=10 kg,15 kg", "--unknown", "half_width", "--impacts"], SOUND, "half_width = '10 kg': half_width is shown in mm"),
        (["--limits", "half_width=8 km,9 km", "--unknown", "half_width", "--impacts"], SOUND, "is implausible for the clearance to either side"),
        (["--unknown", "clearance", "--impacts"], SOUND, "(did you mean 'half_width'?)"),
    ],
)  # fmt: skip
def test_measurements(run, tmp_path, words, data, says):
    (tmp_path / "data.csv").write_text(data)
    assert says in said(run, tmp_path, (HALF, HALF), "calibrate", *words, tmp_path / "data.csv")
