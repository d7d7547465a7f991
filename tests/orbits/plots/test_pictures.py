"""Pictures, tables and scenes of orbits: what they are, where walls and bodies stand, and in which units."""

import re
import warnings

import matplotlib as mpl
import numpy as np
import pytest

import contvines as cv
from orbits import Cavity, Wall, coupled_two
from orbits.machines.physical import physical
from orbits.plots.portrait import title
from orbits.plots.shown import track
from orbits.symbols import cos
from orbits.theory.manifolds import friction_level, impact_loss, symmetry_limit
from tests.machines import ABSORBER, STRONG
from tests.orbits.declared.oscillators import oscillator
from tools.pages.pages import page


@pytest.fixture(autouse=True)
def no_windows():
    mpl.use("Agg")
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        yield


def test_title_names_stability_and_parameters():
    figure = ABSORBER.symmetric_orbit(amplitude=0.55).plot()
    first, second = figure.get_suptitle().splitlines()
    assert first == "LR, 2 impacts in 1 forcing period, symmetric, stable"
    assert second.startswith("$C$ = 0.55, $r$ = 0.76, ") and r"$\Omega$ = 1" in second
    assert "left wall at +1" in figure.axes[0].get_xlabel()


def test_at_a_symmetry_breaking_an_orbit_is_marginal():
    H = friction_level(STRONG["friction"], STRONG["gravity"], STRONG["mass_ratio"])
    breaking = float(symmetry_limit(impact_loss(STRONG["restitution"]), H).amplitude)
    assert ", marginal\n" in title(ABSORBER.symmetric_orbit(amplitude=breaking))
    assert ", unstable\n" in title(ABSORBER.symmetric_orbit(amplitude=0.74))


def test_the_stuck_motion_has_a_picture():
    figure = ABSORBER.orbit("", 1, amplitude=0.05).plot()
    assert figure.get_suptitle().startswith("stuck, the absorber rides with the cavity, stable\n")
    low, high = figure.axes[0].get_xlim()
    assert low > 1 > -1 > high  # the left wall, w = +1, stands on the left


@pytest.mark.parametrize("word", ["LR", ""])
def test_an_orbit_shows_itself_as_a_table(word):
    orbit = ABSORBER.orbit(word, amplitude=0.55 if word else 0.05)
    rows = dict(re.findall(r"<tr><th[^>]*>(.*?)</th><td[^>]*>(.*?)</td></tr>", orbit._repr_html_()))
    assert rows["motion"].startswith(word or "stuck") and "stable" in rows["motion"]
    assert {name: float(rows[name]) for name in orbit.parameters} == pytest.approx(orbit.parameters)
    first = rows["multipliers"].split(",")[0].replace(" ", "").replace("i", "j")
    assert first == "-" or abs(complex(first) - orbit.multipliers[0]) < 1e-4
    least = min(margin.value for margin in orbit.margins)
    assert float(rows["least margin"].split()[0]) == pytest.approx(least, rel=1e-3)


# ---------------------------------------------------------------------------------------------- units
CASES = {
    "coupled": {
        "oscillator_mass": "3.8 kg", "natural_frequency": "8 Hz", "damping_ratio": 0.007, "absorber_mass": "32 g", "half_width": "14 mm",
        "restitution": 0.6, "friction": 0.1, "base_amplitude": "0.3 mm", "frequency": "7.9 Hz",
    },
    "absorber": {"half_width": "14 mm", "restitution": 0.7, "friction": 0.1, "amplitude": "9 mm", "frequency": "8 Hz"},
}  # fmt: skip


@pytest.fixture(params=CASES)
def orbit(request):
    return physical(request.param, CASES[request.param]).orbit("LR")


def test_a_report_shows_millimetres(orbit):
    scene = orbit.scene(2000)
    portrait, history = scene["portrait"], scene["history"]
    assert portrait["walls"] == scene["animation"]["walls"] == pytest.approx([14.0, -14.0])
    w, rate = portrait["x"], portrait["y"]
    assert np.abs(w).max() == pytest.approx(14.0)
    assert "[mm]" in portrait["names"][0] and "[mm/s]" in portrait["names"][1]
    assert history["unit"] == "positions [mm]"
    steps = np.diff(history["x"] / orbit.model.quantities["frequency"])  # seconds
    inside = steps > 1e-9  # at an event there are two samples
    rises = 0.5 * (rate[1:] + rate[:-1])[inside] * steps[inside]
    np.testing.assert_allclose(np.diff(w)[inside], rises, atol=1e-5 * 14.0)
    cavity = history["curves"]["cavity"]
    np.testing.assert_allclose(cavity - history["curves"]["absorber"], w, atol=1e-9)
    for wall, edge in zip((14.0, -14.0), history["walls"]):
        np.testing.assert_allclose(cavity - edge, wall)


def test_a_picture_and_a_page_show_the_quantities(orbit):
    figure = orbit.plot()
    phase, history = figure.axes
    left, right = phase.get_xlim()
    assert left > 14.0 and right < -14.0 and "mm" in phase.get_xlabel() and "mm/s" in phase.get_ylabel()
    assert history.get_ylabel() == "positions [mm]"
    heading = figure.get_suptitle()
    assert "half width = 14 mm" in heading and re.search(r"frequency = (7\.9|8) Hz", heading)
    assert "<td style='text-align:left'>14 mm</td>" in orbit._repr_html_()


def test_a_machine_of_numbers_is_in_half_widths_and_unlike_walls_stand_where_they_are():
    scene = (
        Cavity(restitution=0.5, friction=0.5, gravity=0.2, distance_left=0.9)
        .orbit("LR", amplitude=0.6)
        .scene(200)
    )
    history, places = scene["history"], scene["portrait"]["x"]
    assert scene["portrait"]["walls"] == [0.9, -1.0] and history["unit"] == "positions in units of b"
    assert [np.max(places), np.min(places)] == pytest.approx([0.9, -1.0])
    first = history["curves"]["absorber"][0] - history["walls"][0][0]  # the impact on the left wall
    assert first == pytest.approx(0.0, abs=1e-9)


def test_axes_of_basins_have_units():
    basins = cv.basins(coupled_two, "frequency", at=7.8, points=3)
    axes = basins.plot().axes[0]
    assert axes.get_xlabel().endswith("[mm]") and axes.get_ylabel().endswith("[mm]")
    assert basins.to_dict()["units"] | {"q": "mm", "x1": "mm"} == basins.to_dict()["units"]


# ---------------------------------------------------------------------------------------------- declared machines
def hammer(side, shaken=0.0):
    """A mass on a spring with a wall that is shaken itself: at +gap or -gap, plus shaken cos(phase)."""

    def gap(s, phase, p):
        return p.gap + side * shaken * cos(phase) - side * s.x

    return oscillator(
        lambda s, phase, p, contact: cos(phase) - 0.1 * s.v - s.x,
        Wall("R", gap, {"v": -float(side)}, "restitution"),
        parameters={"frequency": 2.3, "gap": 0.1, "restitution": 0.8},
    )


@pytest.mark.parametrize(("side", "shaken"), [(1, 0.0), (-1, 0.0), (1, 0.02)])
def test_a_wall_stands_where_the_page_puts_it_and_no_body_passes_it(side, shaken):
    orbit = hammer(side, shaken).attractor().orbit
    motion = orbit.sample(200)
    seen = track(orbit, motion)
    assert list(seen["bodies"]) == ["x"] and seen["periods"] == orbit.periods
    (wall,) = seen["walls"]
    assert (wall["name"], wall["side"]) == ("R", side)
    assert wall["at"] == pytest.approx(side * 0.1 + shaken * np.cos(motion["phase"]), abs=1e-12)
    assert (side * (wall["at"] - seen["bodies"]["x"])).min() > -1e-9
    assert orbit.scene(60)["animation"]["walls"][0]["side"] == side
    motion["v"] = np.cos(17.0 * motion["time"])  # a state that is no rate moves nothing
    assert track(orbit, motion) is None


@pytest.fixture(scope="module")
def hit():
    """x'' + x = cos(w t) with a rigid stop at x = 0, hit once in a forcing period."""
    return page("impact_oscillator").orbit("R", 1)


def test_on_given_axes_or_in_a_figure_that_a_notebook_shows(hit):
    figure = hit.plot()
    assert len(figure.axes) == 2 and "R, 1 impact in 1 forcing period" in figure.get_suptitle()
    assert figure._repr_png_()[:4] == b"\x89PNG"
    assert len(hit.plot(figsize=(3.4, 2.4)).axes) == 1  # the phase portrait alone
    figure = mpl.figure.Figure()
    one, two = figure.subplots(1, 2)
    assert hit.plot(axes=[one, two]) is figure
    assert one.lines and two.lines and figure.get_suptitle() == ""


def test_a_scene_is_the_motion_between_its_events(hit):
    scene = hit.scene(200)
    (event,) = scene["events"]
    assert event["event"] == "R" and abs(event["x"]) < 1e-12
    x, v = np.array(scene["portrait"]["x"]), np.array(scene["portrait"]["y"])
    assert event["y"] == pytest.approx(v[0], abs=1e-9) and v[0] == pytest.approx(-0.8 * v[-1], rel=1e-9)
    # x'' + x = cos(psi): between impacts a cos t + b sin t + cos(psi)/(1 - w^2)
    w = hit.parameters["frequency"]
    psi = 2 * np.pi * np.array(scene["history"]["x"])
    t, forced = (psi - psi[0]) / w, np.cos(psi) / (1 - w * w)
    a, b = x[0] - forced[0], v[0] + w * np.sin(psi[0]) / (1 - w * w)
    assert np.abs(a * np.cos(t) + b * np.sin(t) + forced - x).max() < 1e-9
