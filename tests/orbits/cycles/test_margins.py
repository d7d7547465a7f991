"""What each margin watches, and the name of the border at which it vanishes."""

import numpy as np
import pytest

from orbits.words import Word, border_kind, limits_of, margin_name
from tests.machines import ABSORBER

FLIGHT, EVENT, WALL, DURATION = range(4)
# word, event, column -> what is watched, border
TABLE = [
    ("LR", 0, FLIGHT, "flight", "velocity-graze"),
    ("LR", 0, EVENT, "approach", "wall-graze"),
    ("LRtt", 2, EVENT, "turn", "stick"),
    ("LRtt", 2, WALL, "wall", "wall-graze"),
    ("LRtt", 2, DURATION, "duration", "velocity-graze"),
    ("Rs-", 1, FLIGHT, "hold", "stick"),
    ("Rs-", 1, EVENT, "stick", "stick"),
    ("Rs-", 1, WALL, "wall", "wall-graze"),
    ("Rs-", 1, DURATION, "duration", "stick"),
    ("Rs-", 2, EVENT, "slip", "stick"),
    ("Rs-", 2, FLIGHT, "flight", "velocity-graze"),
    ("Rts+L", 1, DURATION, "duration", "stick"),
    ("ss", 1, DURATION, "duration", "stick"),
    ("", 0, FLIGHT, "stick", "stick"),
    ("LLR", 2, FLIGHT, "wall", "wall-graze"),  # without friction flights have walls
    ("LLR", 0, EVENT, "approach", "wall-graze"),
    ("LLR", 0, DURATION, "duration", "vanishing-event"),
]


@pytest.mark.parametrize(("text", "place", "column", "name", "kind"), TABLE)
def test_names_of_margins_and_borders(text, place, column, name, kind):
    word = Word.parse(text, frictionless=text == "LLR")
    assert margin_name(word, 4 * place + column) == name
    assert border_kind(word, 4 * place + column) == kind


@pytest.mark.parametrize("frequency", [0.7, 1.7])
def test_a_slip_s_margin_is_the_rate_at_which_friction_gives_way(frequency):
    """The cavity's acceleration is C Omega^2 sin Psi; it reaches (1 + eps) mu g at the slip, and grows there by C Omega^3 |cos Psi| per time."""
    limit = 1.006 * 0.5 * 0.4
    amplitude = 1.2 * limit / frequency**2
    orbit = ABSORBER.changed(gravity=0.4, frequency=frequency).orbit("ss", amplitude=amplitude)
    (found,) = (margin.value for margin in orbit.margins if margin.kind == "slip")
    cosine = np.sqrt(1.0 - 1.0 / 1.2**2)
    assert found == pytest.approx(amplitude * frequency**3 * cosine, rel=1e-10)


def test_the_limit_of_a_multiplier_that_grows_without_bound_is_infinite():
    """1e15 stands for it, times a direction of length one: in one of five directions the modulus is rounded to less."""
    for growing in np.geomspace(1e-5, 1e8, 500):
        for sign in (-1.0, 1.0):
            listed = np.array([sign * 1e15 * complex(growing) / abs(growing), 0.5])
            assert np.array_equal(limits_of(listed), [sign * np.inf, 0.5])
    pair = limits_of(1e15 * np.exp(np.array([1j, -1j])))
    assert np.isinf(pair.real).all() and np.array_equal(np.sign(pair.imag), [1.0, -1.0])
    assert np.array_equal(limits_of(np.array([1e13, 0.5])), [1e13, 0.5])
