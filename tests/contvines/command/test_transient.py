"""`contvines transient`: a shock against another integrator, a free decay against closed forms, refusals."""

import csv
import json

import numpy as np
import pytest

from tests.orbits.design.laboratory import FREQUENCY, RATIO, STUDY, measurement

G = 9.80665


@pytest.fixture
def study(tmp_path):
    path = tmp_path / "panel.toml"
    path.write_text(STUDY)
    return path


def test_a_shock_in_milliseconds_and_g(run, study, tmp_path):
    """A half-sine of 8 g over 20 ms, written with decimal commas: peak, impacts and the motion as solve_ivp has them."""
    t = np.arange(0.0, 0.0205, 5e-4)
    a = np.round(8.0 * np.sin(np.pi * t / 0.02), 6)
    rows = [f"{1e3 * x:.2f};{y:.6f}".replace(".", ",") for x, y in zip(t, a)]
    (tmp_path / "shock.csv").write_text("time [ms];acceleration [g]\n" + "\n".join(rows))
    hits, instants, places = measurement(
        0.7, 0.15, 0.0, lambda s: float(np.interp(s, t, G * a, right=0.0)), 0.25
    )
    words = ["transient", study, "--record", tmp_path / "shock.csv", "--tail", "230 ms"]
    done = run(*words, "--json", "-o", tmp_path / "out.csv", "--plot", tmp_path / "shock.png")
    found = json.loads(done[1])
    assert found["units"]["peak"] == "mm" and found["impacts"] == hits.size
    assert found["peak"] == pytest.approx(1e3 * np.abs(places).max(), rel=1e-3)
    series = list(csv.DictReader((tmp_path / "out.csv").open()))
    time, moved = (np.array([float(row[name]) for row in series]) for name in ("time [s]", "oscillator [mm]"))
    np.testing.assert_allclose(np.interp(time, instants, 1e3 * places), moved, atol=0.03)
    assert 0.0 < found["absorber_share"] < 1.0 and (tmp_path / "shock.png").exists()


def test_a_free_decay(run, study, tmp_path):
    """Without absorber nine tenths are gone after ln(10)/(2 zeta omega_0); with it sooner."""
    found = json.loads(run("transient", study, "--release", "12 mm", "--json")[1])
    assert found["bare_time"] == pytest.approx(
        np.log(10.0) / (2.0 * RATIO * 2.0 * np.pi * FREQUENCY), rel=1e-9
    )
    assert found["pumping_time"] < found["bare_time"]
    shares = [found[f"{name}_share"] for name in ("impact", "friction", "damping")]
    assert sum(shares) == pytest.approx(1.0, rel=1e-12) and min(shares) > 0.0
    assert "pumping_time" in run("transient", study, "--release", "12 mm")[1]


@pytest.mark.parametrize(
    ("options", "data", "says"),
    [
        ([], None, "none is given"),
        (["--release", "0 mm"], None, "give a number other than 0"),
        (["--release", "12"], None, "has no unit"),
        (["--release", "fast"], None, "--release = 'fast' is not a number with a unit"),
        (["--release", "12 mm", "--tail", "1 s"], None, "this goes with --record"),
        (["--tail", "1"], "0,1\n1,2\n", "has no unit"),
        ([], "time [s],acceleration [mm]\n0,1\n1,2\n", "no unit of this acceleration; expected m/s^2"),
        ([], "0,1\n0,2\n", "do not grow at row 1"),
        ([], "0,1\n0.5,x\n", "row 2 holds '0.5, x', not 2 numbers"),
        ([], "0\n1\n", "row 1 has 1 column; 2 columns are needed"),
    ],
)
def test_bad_options_and_records_get_a_sentence(run, study, tmp_path, options, data, says):
    if data is not None:
        (tmp_path / "shock.csv").write_text(data)
        options = ["--record", tmp_path / "shock.csv", *options]
    done = run("transient", study, *options)
    assert done[0] and says in done[2], done[2]


def test_a_machine_without_oscillator_is_refused(run, tmp_path):
    (tmp_path / "s.toml").write_text(
        '[model]\nname = "absorber"\nrestitution = 0.7\nfriction = 0.1\ngravity = 0.2\nmass_ratio = 0.01\n'
        '[start]\nword = "LR"\namplitude = 0.5\n[continue]\nparameter = "amplitude"\nwithin = [0.3, 0.8]\n'
    )
    assert "has no oscillator" in run("transient", tmp_path / "s.toml", "--release", "1")[2]


def test_transients_of_pages(run, tmp_path):
    (tmp_path / "two.toml").write_text(
        '[model]\nname = "coupled_two"\n[start]\nfrequency = 8.0\n[continue]\nparameter = "frequency"\nwithin = [7.6, 8.4]\n'
    )
    done = run(
        "transient",
        tmp_path / "two.toml",
        "--start-up",
        "--json",
        "-o",
        tmp_path / "o.csv",
        "--plot",
        tmp_path / "p.png",
    )
    told = json.loads(done[1])
    rows = np.genfromtxt(tmp_path / "o.csv", delimiter=",", skip_header=1)
    assert (
        told["largest_q"] == pytest.approx(np.abs(rows[:, 1]).max(), rel=1e-3)
        and told["units"]["peak_force"] == "N"
    )
    assert told["peak_force"] == pytest.approx(told["impulse"] * np.pi / 1e-3, rel=1e-12)
    risen = json.loads(
        run("transient", tmp_path / "two.toml", "--start-up", "--from", "4 Hz", "--over", "3 s", "--json")[1]
    )
    assert risen["settled_q"] > 3.0
    free = json.loads(
        run(
            "transient",
            tmp_path / "two.toml",
            "--release",
            "q = 20 mm, x1 = 1.8 cm, x2 = 18 mm",
            "--time",
            "1 s",
            "--json",
        )[1]
    )
    assert free["largest_q"] == pytest.approx(20.0) and 0.0 < free["taken_share"] < 1.0
