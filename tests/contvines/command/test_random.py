"""`contvines random`: in SI against the closed form for white noise, files, refusals."""

import csv
import json
from pathlib import Path

import numpy as np
import pytest

from tests.orbits.design.laboratory import FREQUENCY, RATIO, STUDY

EXAMPLE = Path(__file__).parents[3] / "examples" / "design" / "random.toml"
PAGE = '[model]\nname = "coupled_two"\n[start]\nfrequency = 8.0\n[continue]\nparameter = "frequency"\nwithin = [7.6, 8.4]\n'


def test_the_bare_oscillator_in_si(run, tmp_path):
    """A wide band about the resonance: nearly white noise, variance S / (8 zeta omega_0^3) with S per hertz, one-sided."""
    (tmp_path / "s.toml").write_text(
        STUDY + "\n[random]\npsd = [[0.5, 0.01], [80, 0.01]]\nperiods = 4000\nrecords = 2\n"
    )
    done = run(
        "random", tmp_path / "s.toml", "--json", "-o", tmp_path / "o.csv", "--plot", tmp_path / "p.png"
    )
    assert done[0] == 0, done[2]
    told = json.loads(done[1])
    omega = 2 * np.pi * FREQUENCY
    white = 1e3 * np.sqrt(0.01 / (8 * RATIO * omega**3))
    assert told["units"]["rms_bare"] == "mm" and told["rms_bare"]["value"] == pytest.approx(white, rel=0.02)
    rows = list(csv.DictReader((tmp_path / "o.csv").open()))
    f, s = (np.array([float(row[name]) for row in rows]) for name in ("frequency [Hz]", "bare [mm^2/Hz]"))
    assert np.sqrt(np.sum(s) * (f[1] - f[0])) == pytest.approx(told["rms_bare"]["value"], rel=1e-2)
    assert (tmp_path / "p.png").exists()
    again = json.loads(run("random", tmp_path / "s.toml", "--json", "--seed", "0")[1])
    assert again == told
    assert "+-" in run("random", tmp_path / "s.toml")[1]


def test_the_power_is_that_of_white_noise(run):
    """Ito: white noise of the one-sided density S per hertz puts m S / 4 into a mass m; from 4 to 16 Hz it is nearly white about 8 Hz."""
    done = run("random", EXAMPLE, "--json")
    told = json.loads(done[1])
    assert told["units"]["absorber_power"] == "mW"
    power = 1e-3 * told["absorber_power"]["value"] / told["absorber_share"]["value"]
    assert power == pytest.approx((3.8 + 0.032) * 0.1 / 4.0, rel=0.05)


@pytest.mark.parametrize(
    ("text", "says"),
    [
        (STUDY, "the section [random] is missing"),
        (STUDY + "\n[random]\npsd = [[2, 0.1]]\n", "rows [frequency, density]"),
        (STUDY + "\n[random]\npsd = [[20, 0.1], [2, 0.1]]\n", "ascending"),
        (STUDY + '\n[random]\npsd = [[2, 0.1], [20, 0.1]]\nparameter = "friction"\n', "leave it out"),
        (PAGE + "[random]\npsd = [[2, 0.1], [20, 0.1]]\n", "name the parameter that is random"),
        (PAGE + '[random]\npsd = [[2, 0.1], [20, 0.1]]\nparameter = "frequency"\n', "sets the clock"),
        (
            PAGE + '[random]\npsd = [[2, 0.1], [20, 0.1]]\nparameter = "clearance_1"\n',
            "wall 'L1' depends on it",
        ),
        (
            PAGE + '[random]\npsd = [[2, 0.1], [20, 0.1]]\nparameter = "frequenc"\n',
            "did you mean 'frequency'",
        ),
    ],
)
def test_what_cannot_be_gets_a_sentence(run, tmp_path, text, says):
    (tmp_path / "s.toml").write_text(text)
    done = run("random", tmp_path / "s.toml")
    assert done[0] and says in done[2], done[2]
