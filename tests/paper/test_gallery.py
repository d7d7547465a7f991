"""Every gallery script runs without a window, and prints the numbers that its docstring claims."""

import importlib
import sys
from pathlib import Path

import pytest
from pytest import approx

pytestmark = pytest.mark.slow

GALLERY = Path(__file__).parents[2] / "examples" / "gallery"
HELPERS = {"paper", "two_impacts"}
SCRIPTS = sorted(p.stem for p in GALLERY.glob("*.py") if p.stem not in HELPERS)


@pytest.fixture(scope="module")
def gallery():
    sys.path.insert(0, str(GALLERY))
    yield importlib.import_module("paper")
    sys.path.remove(str(GALLERY))
    for name in (*SCRIPTS, *HELPERS):
        sys.modules.pop(name, None)


# Printed numbers by the script that prints them
VALUES = {
    "sawtooth": {
        "kappa by quadrature": approx(0.81056947, abs=1e-7),
        "excess of the paper": approx(0.0311, abs=1e-4),
    },
    "equilibria": {
        "sigma = 5.1: steady states with impacts": 0,
        "sigma = 1.25: steady states with impacts": 2,
        "sigma = 3.65: steady states with impacts": 2,
        "sigma = -4.4: steady states with impacts": 2,
        "sigma = 5.1: Omega (printed 1.039)": approx(1.0306, abs=1e-12),
        "sigma = 1.25: Omega (printed 1.007)": approx(1.007, abs=1e-3),
        "sigma = 3.65: Omega (printed 1.022)": approx(1.022, abs=1e-3),
        "sigma = -4.4: Omega (printed 0.973)": approx(0.973, abs=1e-3),
    },
    "branches": {"C^2_min": approx(0.0233851, abs=1e-7), "C^2_max": approx(0.4961028, abs=1e-7)},
    "stability_region": {
        "fold, C^2": approx(0.0637942, abs=1e-7),
        "symmetry breaking, C^2": approx(0.5282903, abs=1e-7),
        "border of the real branch, C^2": approx(0.73, abs=0.01),
        "multiplier -1 of the bare maps, C^2": approx(0.8679, abs=1e-4),
        "least s w' of that orbit (negative: not a motion)": approx(-0.110, abs=1e-3),
    },
    "multipliers": {"det A / r^4, least and largest": approx((1.0, 1.0), abs=1e-9)},
    "verification": {
        "Omega = 0.977: word, periods, impacts": ("LR", 1, 2),
        "Omega = 0.977: symmetric": True,
        "Omega = 0.983: word, periods, impacts": ("LR", 1, 2),
        "Omega = 0.983: symmetric": False,
        "Omega = 0.986, friction's sign frozen: periods until it repeats (0: not found)": 2,
    },
    "stick_slip": {"frequency in Hz": approx(7.25, abs=1e-3)},
    "coexisting_equilibria": {"steady states": 3},
    "coexistence_runs": {"sliding: word": "tt", "impacting: word": "LR"},
    "combined_response": {"q1_min, q1_max in mm": approx((5.058, 14.539), abs=1e-3)},
    # an imperfection h moves the fold like h^(2/3)
    "inclined_cavity": {"power of the slope with which it moves": approx((2 / 3, 2 / 3), abs=0.01)},
    "closure": {
        "closure exact: order in B between the two smallest mass ratios": approx(1.0, abs=5e-3),
        "closure exact: order in C^2 between the two smallest mass ratios": approx(1.0, abs=5e-3),
        "closure exact: distance in B, C^2 at eps -> 0": approx((0.0, 0.0), abs=1e-6),
        "closure paper: distance in B, C^2 at eps -> 0": approx((-5.77e-4, -1.125e-3), rel=0.01),
    },
}
# Numbers that are below a bound
BELOW = {
    "free_motion": {"largest distance of the impacts from the manifold, in C^2, above 1.1 C^2_min": 0.03},
    "branches": {"free motion: largest distance from the mean curve in C^2": 0.03},
    "multipliers": {"largest difference between printed and computed multipliers": 1e-11},
    "sliding_response": {
        "largest C Omega^2/(1 + eps) of a simulated stick-slip motion": 0.19645,
        "largest difference in C between averaged and simulated sliding": 0.01,
    },
    "impacting_response": {"largest relative difference in C, averaged to simulated": 0.03},
    "charts": {
        "friction: largest distance of fold and symmetry breaking from their closed forms": 1e-12,
        "restitution: largest distance of fold and symmetry breaking from their closed forms": 1e-12,
    },
}


def check_free_motion(n):
    assert n["C^2 where the simulated absorber lets go"] == approx(n["C^2_min of the manifold"], rel=0.2)
    released = n["slow time to release, exact closure"]
    assert n["slow time to release, simulated"] == approx(released, rel=0.06)
    assert n["least margin of that machine's symmetric orbits between them"] > 0


def check_verification(n):
    assert n["Omega = 0.986: word, periods, impacts"][1:] == (1, 2)


def check_sticking_limit(n):
    assert n["simulated, 0.2 % inside"][0] == "stuck"
    assert n["simulated, 0.2 % outside"][0] == "sliding"


def check_sliding_response(n):
    assert n["smallest C Omega^2/(1 + eps) of a simulated sliding motion"] > 0.19645


def check_stick_slip(n):
    assert n["word"].replace("u", "").startswith("s")
    assert n["stuck for good below"] < n["amplitude C"] < n["no sticking above"]


def check_impacting_response(n):
    assert "hopf on the repelling part (sigma, B, C^2)" in n
    assert n["backbone at B = 1: C, sigma_R"][1] != approx(n["sigma_R there as printed"], rel=0.1)


def check_friction_or_none(n):
    below, above = n["C at sigma = -3.0 with, without friction"], n["C at sigma = 3.0 with, without friction"]
    assert below[0] < below[1] and above[0] > above[1]
    assert n["mu = 0.5: alpha_c, beta_c, offset"][0] == n["mu = 0: alpha_c, beta_c, offset"][0]
    assert n["mu = 0.5: simulated C after 125 periods"] > n["mu = 0.0: simulated C after 125 periods"]


def check_coexistence_runs(n):
    for kind in ("sliding", "impacting"):
        simulated, slow = n[f"{kind}: C^2 simulated, slow flow"]
        assert simulated == approx(slow, rel=0.02)
    assert n["G = 1.65, sigma = 5, mu = 0.0, from q1 = q2 = b"][0] == "chaotic"
    assert n["G = 1.65, sigma = 5, mu = 0.5, from q1 = q2 = b"][0] == "sliding"


def check_sweeps(n):
    assert n["down: motions met"]["LR symmetric"] > 10
    assert n["up: motions met"]["tt"] > 20


def check_inclined_cavity(n):
    # closed form of the level cavity (MODEL: C^2 = 0.5282903)
    assert n["symmetry breaking of the level cavity"] ** 2 == approx(0.5282903, abs=1e-7)


def check_charts(n):
    # the meeting of the second doubling with the border is confirmed by an independent solve in the tests of loci
    assert (1.151736, 0.552311) in n["friction: points of codimension two"].values()


@pytest.mark.parametrize("name", SCRIPTS)
def test_script(name, gallery, tmp_path):
    script = importlib.import_module(name)
    numbers = gallery.run(name, script.main, tmp_path)
    assert (tmp_path / f"{name}.png").stat().st_size > 10_000
    assert f'paper.run("{name}", main)' in Path(str(script.__file__)).read_text()  # as a script, too
    assert script.__doc__ and any(word in script.__doc__ for word in ("Confirms", "Refines", "Contradicts"))
    values, bounds, check = VALUES.get(name, {}), BELOW.get(name, {}), globals().get(f"check_{name}")
    assert values or bounds or check
    assert {key: numbers[key] for key in values} == values
    assert all(numbers[key] < bound for key, bound in bounds.items())
    if check:
        check(numbers)


@pytest.mark.parametrize("name", ["sawtooth", "stability_region"])
def test_a_picture_fits_a_column(name, gallery, tmp_path, monkeypatch):
    from PIL import Image

    monkeypatch.setattr(gallery, "width", 3.4)
    gallery.run(name, importlib.import_module(name).main, tmp_path)
    assert Image.open(tmp_path / f"{name}.png").width == 765  # 3.4 inches at 225 dots an inch
