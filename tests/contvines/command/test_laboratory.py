"""A panel in a laboratory: `contvines transient`, `calibrate`, `random` and `design` against another integrator and closed forms."""

import numpy as np
import pytest
from matplotlib.image import imread

from contvines.command.calibrate import calibration_text
from orbits.design.calibration import Calibration
from tests.contvines.studies import EXAMPLES, PAPER, TWO, table
from tests.orbits.design.laboratory import FREQUENCY, RATIO, STUDY, measurement

G = 9.80665


@pytest.fixture
def told(run, tmp_path):
    """What a line says in JSON of s.toml, the study of the panel or another one."""

    def ask(line, study=STUDY):
        (tmp_path / "s.toml").write_text(study)
        verb, *words = line.split(" ", 1)
        return run.json(" ".join([verb, "s.toml", *words]))

    return ask


def columns(path, *names):
    return (np.array([float(row[name]) for row in table(path)]) for name in names)


# ---------------------------------------------------------------- transient
def test_a_shock_in_milliseconds_and_g(told, tmp_path):
    """A half-sine of 8 g over 20 ms, written with decimal commas: peak, impacts and the motion as solve_ivp has them."""
    t = np.arange(0.0, 0.0205, 5e-4)
    a = np.round(8.0 * np.sin(np.pi * t / 0.02), 6)
    rows = [f"{1e3 * x:.2f};{y:.6f}".replace(".", ",") for x, y in zip(t, a)]
    (tmp_path / "shock.csv").write_text("time [ms];acceleration [g]\n" + "\n".join(rows))
    hits, instants, places = measurement(
        0.7, 0.15, 0.0, lambda s: float(np.interp(s, t, G * a, right=0.0)), 0.25
    )
    found = told("transient --record shock.csv --tail '230 ms' -o out.csv --plot shock.png")
    assert found["units"]["peak"] == "mm" and found["impacts"] == hits.size
    assert found["peak"] == pytest.approx(1e3 * np.abs(places).max(), rel=1e-3)
    time, moved = columns(tmp_path / "out.csv", "time [s]", "oscillator [mm]")
    np.testing.assert_allclose(np.interp(time, instants, 1e3 * places), moved, atol=0.03)
    assert 0.0 < found["absorber_share"] < 1.0 and (tmp_path / "shock.png").exists()


def test_a_free_decay(told, run):
    """Without absorber nine tenths are gone after ln(10)/(2 zeta omega_0); with it sooner. Nothing needs to shake."""
    found = told("transient --release '12 mm'", STUDY.replace("6 N", "0 N"))
    lasts = np.log(10.0) / (2.0 * RATIO * 2.0 * np.pi * FREQUENCY)
    assert found["bare_time"] == pytest.approx(lasts, rel=1e-9)
    assert found["pumping_time"] < found["bare_time"]
    shares = [found[f"{name}_share"] for name in ("impact", "friction", "damping")]
    assert sum(shares) == pytest.approx(1.0, rel=1e-12) and min(shares) > 0.0
    assert "pumping_time" in run.ok("transient s.toml --release '12 mm'")


def test_transients_of_declared_machines(told, tmp_path):
    found = told("transient --start-up -o o.csv --plot p.png", TWO)
    rows = np.genfromtxt(tmp_path / "o.csv", delimiter=",", skip_header=1)
    assert found["largest_q"] == pytest.approx(np.abs(rows[:, 1]).max(), rel=1e-3)
    assert found["units"]["peak_force"] == "N"
    assert found["peak_force"] == pytest.approx(found["impulse"] * np.pi / 1e-3, rel=1e-12)
    risen = told("transient --start-up --from '4 Hz' --over '3 s'", TWO)
    assert risen["settled_q"] > 3.0
    free = told("transient --release 'q = 20 mm, x1 = 1.8 cm, x2 = 18 mm' --time '1 s'", TWO)
    assert free["largest_q"] == pytest.approx(20.0) and 0.0 < free["taken_share"] < 1.0


# ---------------------------------------------------------------- calibrate
@pytest.mark.slow
def test_restitution_and_friction_of_a_free_decay(told, tmp_path):
    hits = measurement(0.66, 0.11, 12e-3, lambda t: 0.0, 1.0, most=24)[0]
    noisy = 1e3 * (hits + 0.35) + np.random.default_rng(3).normal(0.0, 0.05, hits.size)
    (tmp_path / "hits.csv").write_text("time [ms]\n" + "\n".join(f"{t:.5f}" for t in noisy))
    line = "calibrate --impacts hits.csv --release '12 mm' --unknown restitution --unknown friction"
    found = told(line + " --plot c.png --size 3.4 2.4")
    for name, true in (("restitution", 0.66), ("friction", 0.11)):
        low, high = found["intervals"][name]
        assert low < true < high
    low, high = found["intervals"]["restitution"]
    assert high - low < 0.02 and 3e-5 < found["scatter"] < 8e-5  # s: the noise is 5e-5
    assert imread(tmp_path / "c.png").shape[:2] == (480, 680)  # at 200 dots an inch


@pytest.mark.parametrize(("scatter", "doubtful"), [(0.03, False), (0.09, True)])
def test_a_scatter_that_no_clock_has_is_doubtful(scatter, doubtful):
    """Hand-made estimates of impacts 4 s apart: 1 % of that is 40 ms."""
    found = Calibration(
        {"restitution": 0.7}, {"restitution": (0.6, 0.8)}, 0.95, scatter, np.zeros(12), np.eye(1), between=4.0
    )
    said = calibration_text(found, {}, {"restitution": 0.6})
    assert ("doubtful: the scatter is 2.2 % of" in said) == doubtful


# ---------------------------------------------------------------- random
def test_the_bare_oscillator_in_si(told, run, tmp_path):
    """A wide band about the resonance: nearly white noise, variance S / (8 zeta omega_0^3) with S per hertz, one-sided."""
    study = STUDY + "\n[random]\npsd = [[0.5, 0.01], [80, 0.01]]\nperiods = 4000\nrecords = 2\n"
    found = told("random -o o.csv --plot p.png", study)
    white = 1e3 * np.sqrt(0.01 / (8 * RATIO * (2 * np.pi * FREQUENCY) ** 3))
    assert found["units"]["rms_bare"] == "mm" and found["rms_bare"]["value"] == pytest.approx(white, rel=0.02)
    f, s = columns(tmp_path / "o.csv", "frequency [Hz]", "bare [mm^2/Hz]")
    assert np.sqrt(np.sum(s) * (f[1] - f[0])) == pytest.approx(found["rms_bare"]["value"], rel=1e-2)
    assert (tmp_path / "p.png").exists()
    assert told("random --seed 0", study) == found
    assert "+-" in run.ok("random s.toml")


def test_the_power_is_that_of_white_noise(told):
    """Ito: white noise of the one-sided density S per hertz puts m S / 4 into a mass m; from 4 to 16 Hz it is nearly white about 8 Hz."""
    found = told("random", (EXAMPLES / "design" / "random.toml").read_text())
    assert found["units"]["absorber_power"] == "mW"
    power = 1e-3 * found["absorber_power"]["value"] / found["absorber_share"]["value"]
    assert power == pytest.approx((3.8 + 0.032) * 0.1 / 4.0, rel=0.05)


# ---------------------------------------------------------------- design
def test_a_design_in_a_table_in_si_and_in_a_picture(told, run, tmp_path):
    """By hand: R = 3/22, h = (pi/2)(1.006)(0.1055); C_min = (pi h + 2 R)/sqrt(pi^2 + 4 R^2); b = 20 mm."""
    found = told("design --no-plot", PAPER)
    R, h = 3 / 22, np.pi / 2 * 1.006 * 0.1055
    threshold = 0.02 * (np.pi * h + 2 * R) / np.sqrt(np.pi**2 + 4 * R**2)
    assert found["q1_min"]["value"] == pytest.approx(threshold, rel=1e-12) and found["q1_min"]["unit"] == "m"
    assert found["xi"]["value"] == pytest.approx(np.sqrt(0.5282903 / 0.0637942), rel=1e-6)
    out = run.ok("design s.toml --plot map.png")
    assert (tmp_path / "map.png").stat().st_size > 20_000
    assert "..." not in out
    for said in ("activation threshold", "ratio, large amplitude", "operating ratio", "q1_min", "mm", "xi"):
        assert said in out
