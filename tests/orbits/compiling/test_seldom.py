"""Functions that are compiled once they have done some work."""

import numpy as np
import pytest
from numba import njit

from contvines_ground.parts import part
from orbits.compiling import seldom
from orbits.compiling.seldom import Seldom


@part(error_model="numpy", forceinline=True)
def square(x):
    return x * x


def _squares(values, out):
    for i in range(values.shape[0]):
        out[i] = square(values[i]) / values[0]


@pytest.fixture
def patient(monkeypatch):
    monkeypatch.setattr(seldom, "cached", lambda function: False)
    return Seldom(njit(error_model="numpy")(_squares), lambda values, out: values.size, 5, square=square)


def test_it_is_interpreted_until_compiling_pays(patient):
    out = np.zeros(3)
    for _ in range(2):
        patient(np.array([2.0, 4.0, 6.0]), out)
        assert out.tolist() == [2.0, 8.0, 18.0]
        assert not patient.compiled.overloads
    patient(np.array([2.0, 4.0, 6.0]), out)
    assert out.tolist() == [2.0, 8.0, 18.0]
    assert patient.compiled.overloads


def test_what_is_kept_on_disk_is_not_interpreted(patient, monkeypatch):
    monkeypatch.setattr(seldom, "cached", lambda function: True)
    patient(np.array([2.0, 4.0]), np.zeros(2))
    assert patient.compiled.overloads


def test_interpreted_or_compiled_the_numbers_are_the_same(patient):
    values, plain, compiled = np.random.default_rng(3).standard_normal((3, 40))
    patient(values, plain)
    patient.compiled(values, compiled)
    assert np.array_equal(plain, compiled)


def test_no_warning_where_numbers_leave_their_range(patient, recwarn):
    out = np.zeros(2)
    patient(np.array([1e-320, 1e300]), out)
    patient(np.array([0.0, 0.0]), out)
    assert np.isnan(out).all() and not recwarn.list
