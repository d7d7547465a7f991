"""Arithmetic that keeps its digits, against forty digits."""

import mpmath as mp
import pytest

from orbits.compiling.digits import remainders, shift, wrap

plain = [getattr(f, "py_func", f) for f in (remainders, wrap, shift)]


@pytest.mark.parametrize("x", [1e-9, -3e-5, 1e-3, 0.02, 0.3, 0.49, -0.4999, 0.5001, 0.51, 2.0, 6.0])
def test_remainders_of_sine_and_cosine(x):
    with mp.workdps(60):
        z = mp.mpf(x)
        expected = mp.sin(z), 1 - mp.cos(z), z - mp.sin(z), z * z / 2 - 1 + mp.cos(z)
        for found, wanted in zip(plain[0](x), expected):
            assert abs(found / wanted - 1) < 1e-13


@pytest.mark.parametrize("angle", [0.3, -0.3, 6.0, 7.0, 700.0, -700.0, -1e-18])
def test_wrapped_angles_are_the_same_angle(angle):
    reduced, turns = plain[1](angle)
    assert 0.0 <= reduced < 6.283185307179586
    assert abs(mp.mpf(reduced) + 2 * mp.pi * int(turns) - mp.mpf(angle)) < 1e-12


def test_a_sum_of_two_floats_keeps_what_one_would_lose():
    w, low = 1.0, 0.0
    with mp.workdps(40):
        exact = mp.mpf(1)
        for step in (1e-17, 3e-9, -1e-20, 0.7, -1.1e-12, 2e-17, -0.6):
            w, low = plain[2](w, low, step)
            exact += mp.mpf(step)
            assert abs(mp.mpf(w) + mp.mpf(low) - exact) < 1e-31


def test_what_is_kept_on_disk_is_named_by_the_sources_it_calls(tmp_path):
    """A kernel whose helpers have changed is another one: its name carries a digest of their files, and changes with it."""
    from types import ModuleType

    from orbits.compiling.decorators import digest_of, stored_with

    def kernel(x):
        return x

    module, names = ModuleType("helper"), []
    for text in ("a = 1", "a = 2", "a = 1"):
        module.__file__ = str(tmp_path / "helper.py")
        (tmp_path / "helper.py").write_text(text)
        kernel.__qualname__ = "kernel"
        names.append(stored_with(module)(kernel).py_func.__qualname__)
        assert digest_of(module) in names[-1]
    assert names[0] == names[2] != names[1]
