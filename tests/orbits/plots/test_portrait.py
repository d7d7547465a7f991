"""The portrait of an orbit says what the orbit is and where it lives, without warnings."""

import warnings

import matplotlib as mpl
import numpy as np
import pytest

from orbits import Absorber
from orbits.plots.portrait import title

MACHINE = {"restitution": 0.76, "friction": 0.5, "gravity": 0.211, "mass_ratio": 0.006}


@pytest.fixture(autouse=True)
def no_windows():
    mpl.use("Agg")


def drawn(orbit):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        return orbit.plot()


def test_title_names_stability_and_parameters():
    figure = drawn(Absorber(**MACHINE).symmetric_orbit(amplitude=0.55))
    first, second = figure.get_suptitle().splitlines()
    assert first == "LR, 2 impacts in 1 forcing period, symmetric, stable"
    assert second.startswith("$C$ = 0.55, $r$ = 0.76, ") and r"$\Omega$ = 1" in second
    assert "left wall at +1" in figure.axes[0].get_xlabel()


def test_at_a_symmetry_breaking_an_orbit_is_marginal():
    # C^2 of the symmetry breaking, from its closed form (tests/test_examples.py)
    R, H = 0.24 / 1.76, np.pi / 2 * 1.006 * 0.5 * 0.211
    beta = (2 * np.pi - 4 * R * H) / (np.pi**2 - 4)
    breaking = (1 - np.pi * beta / 2) ** 2 + (R * beta + H) ** 2
    absorber = Absorber(**MACHINE)
    assert ", marginal\n" in title(absorber.symmetric_orbit(amplitude=float(np.sqrt(breaking))))
    assert ", unstable\n" in title(absorber.symmetric_orbit(amplitude=0.74))


def test_the_stuck_motion_has_a_picture():
    figure = drawn(Absorber(**MACHINE).orbit("", 1, amplitude=0.05))
    assert figure.get_suptitle().startswith("stuck, the absorber rides with the cavity, stable\n")
    low, high = figure.axes[0].get_xlim()
    assert low > 1 > -1 > high  # the left wall, w = +1, stands on the left
