"""Compiled functions that only compiled functions call."""

import math
import pickle
import subprocess
import sys

import numpy as np
import pytest
from numba import config, njit
from numba.core.errors import TypingError

from contvines_ground import parts
from contvines_ground.parts import from_python, part

pytestmark = pytest.mark.skipif(bool(config.DISABLE_JIT), reason="nothing is compiled")
known = pytest.mark.skipif(parts.Part is None, reason="a numba that is not known here compiles as it likes")


@part(error_model="numpy", forceinline=True)
def hypotenuse(a, b):
    return math.sqrt(a * a + b * b)


@part(error_model="numpy")
def longest(sides):
    found = 0.0
    for i in range(sides.shape[0]):
        found = max(found, hypotenuse(sides[i, 0], sides[i, 1]))
    return found


@njit(error_model="numpy")
def twice(sides):
    return 2.0 * longest(sides)


SIDES = np.array([[3.0, 4.0], [5.0, 12.0], [8.0, 15.0]])


def test_parts_of_parts_are_linked_into_what_python_calls():
    assert twice(SIDES) == 34.0


@known
def test_of_a_part_there_is_no_machine_code():
    assert twice(SIDES) == 34.0
    for function in (hypotenuse, longest):
        (compiled,) = function.overloads.values()
        assert not callable(compiled.entry_point)
    (compiled,) = twice.overloads.values()
    assert callable(compiled.entry_point)


def test_python_may_call_a_part_with_any_types():
    assert hypotenuse(3.0, 4.0) == 5.0
    assert hypotenuse(5, 12) == 13.0
    assert hypotenuse(3.0, 4.0) == 5.0
    assert longest(SIDES) == 17.0
    assert longest(SIDES[:, ::-1]) == 17.0


def test_what_no_compiler_can_type_is_refused_as_by_numba():
    with pytest.raises(TypingError):
        hypotenuse("3", "4")


def test_a_part_can_be_sent_to_another_process():
    assert pickle.loads(pickle.dumps(longest))(SIDES) == 17.0


def test_a_part_takes_the_compilers_options():
    @part(error_model="python")
    def share(a, b):
        return a / b

    @njit(error_model="numpy")
    def caller(a, b):
        return share(a, b)

    with pytest.raises(ZeroDivisionError):
        caller(1.0, 0.0)


def test_with_another_numba_a_part_is_a_function_like_any(monkeypatch):
    monkeypatch.setattr(parts, "Part", None)

    @part(error_model="numpy")
    def half(a):
        return 0.5 * a

    @njit(error_model="numpy")
    def caller(a):
        return half(a) + 1.0

    assert half(3.0) == 1.5
    assert caller(3.0) == 2.5


@known
def test_python_calls_what_is_kept_on_disk_where_there_is_such_a_function():
    @part(error_model="numpy")
    def third(a):
        return a / 3.0

    @njit(error_model="numpy")
    def caller(a):
        return third(a)

    assert from_python(third, caller) is third
    from_python(third, njit(lambda a: 0.0 * a))  # the first one stays
    assert third(6.0) == 2.0
    assert len(caller.overloads) == 1


NEWER = """
import numba
numba.version_info = numba.version_info._replace(short=(9, 1), string="9.1.0")
from contvines_ground import parts
assert parts.Part is None and parts.MAKER == {}
print(parts.part()(lambda a: a + 1.0)(2.0), parts.whole()(lambda a: 2.0 * a)(2.0))
"""


def test_a_numba_that_is_not_known_compiles_as_it_likes():
    told = subprocess.run([sys.executable, "-c", NEWER], capture_output=True, text=True, check=True)
    assert told.stdout.split() == ["3.0", "4.0"]
