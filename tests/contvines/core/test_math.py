"""Sines, cosines and exponentials of the native core against mpmath, within one unit in the last place; both variants alike."""

import ctypes

import mpmath
import numpy as np
import pytest

from contvines.core.build import path_of, variants
from contvines.core.library import native

pytestmark = pytest.mark.skipif(not native(), reason="no native core")


def arguments(largest):
    generator = np.random.default_rng(5)
    near = np.arange(-400, 400) * (np.pi / 4) * (1.0 + generator.uniform(-1e-15, 1e-15, 800))
    drawn = generator.uniform(-largest, largest, 1500)
    small = 10.0 ** generator.uniform(-300, 0, 200)
    return np.concatenate([near, drawn, small, -small, [0.0, -0.0]])


def core(name, variant, x, rows):
    """What a function of the core writes for these arguments."""
    found = np.empty((rows, len(x)))
    places = [array.ctypes.data_as(ctypes.c_void_p) for array in (x, *found)]
    getattr(ctypes.CDLL(str(path_of(variant))), name)(ctypes.c_int64(len(x)), *places)
    return found


def sines_cosines(variant, x):
    return core("core_sines_cosines", variant, x, 2)


def exponentials(variant, x):
    return core("core_exponentials", variant, x, 1)[0]


def in_last_places(found, function, x):
    """Largest distance from the true value in units of the last place."""
    with mpmath.workdps(50):
        away = [abs(mpmath.mpf(a) - function(mpmath.mpf(b))) for a, b in zip(found.tolist(), x.tolist())]
    return (np.array(away, dtype=float) / np.spacing(np.abs(found))).max()


@pytest.mark.parametrize("largest", [1.0, 50.0, 1e6])
def test_sines_and_cosines_are_right_to_the_last_place(largest):
    x = arguments(largest)
    sines, cosines = sines_cosines("baseline", x)
    assert in_last_places(sines, mpmath.sin, x) < 1.0
    assert in_last_places(cosines, mpmath.cos, x) < 1.0


def test_exponentials_are_right_to_the_last_place():
    x = np.concatenate([np.random.default_rng(6).uniform(-740.0, 709.0, 2000), np.linspace(-1.0, 1.0, 500)])
    assert in_last_places(exponentials("baseline", x), mpmath.exp, x) < 1.01


def test_arguments_that_are_no_numbers():
    x = np.array([np.nan, np.inf, -np.inf])
    assert np.isnan(sines_cosines("baseline", x)).all()
    assert np.array_equal(exponentials("baseline", x), [np.nan, np.inf, 0.0], equal_nan=True)


@pytest.mark.skipif(not native() or "avx2" not in variants(), reason="one variant only")
def test_both_variants_give_the_same_bits():
    x = arguments(300.0)
    try:
        other = sines_cosines("avx2", x)
    except OSError:
        pytest.skip("no AVX2")
    assert sines_cosines("baseline", x).tobytes() == other.tobytes()
    assert exponentials("baseline", x).tobytes() == exponentials("avx2", x).tobytes()
