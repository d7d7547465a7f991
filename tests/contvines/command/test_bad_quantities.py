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
    assert (
        f"{name} = 0 {unit}: nothing shakes the machine, whatever frequency is; for example {name} = " in text
    )


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
    assert 'for example base_amplitude = "0.3 mm"' in error


def test_a_free_decay_needs_no_shaking(run, tmp_path):
    (tmp_path / "s.toml").write_text(STUDY.replace(BASE, 'base_amplitude = "0 mm"'))
    assert run("transient", tmp_path / "s.toml", "--release", "12 mm")[0] == 0


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
