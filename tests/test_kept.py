"""Tuples and functions that compiled code is handed by address."""

import os
import subprocess
import sys
from types import SimpleNamespace

import numpy as np
import pytest
from numba import njit
from numba.core.errors import TypingError

from contvines_ground.by_address import NUMBER, WHOLE, address_of, caller, loader
from contvines_ground.kept import OPTIONS, Keeper
from contvines_ground.outlined import Outlined, callers, outlined

PROGRAM = """
import numpy as np
from contvines_ground.kept import Keeper
assert Keeper(lambda kind, mark: abs, "of_this_test").keep((np.zeros(2), 0.5))[0] is abs
"""


def test_tuples_are_kept_by_their_types():
    """A tuple of other types is not read as one of those that came before."""
    made, marks = [], set()

    def make(kind, mark):
        marks.add(mark)
        unpack = loader(kind)

        def total(address):
            array, number = unpack(address)
            for value in array.flat:
                number += value
            return number

        made.append(total)
        return njit(**OPTIONS)(total)

    keeper = Keeper(make, "of_this_test")
    for array in (np.arange(3.0), np.arange(4.0), np.arange(6.0).reshape(2, 3), np.arange(5)):
        function, address, memory = keeper.keep((array, 0.5))
        assert memory is not None and function(address) == array.sum() + 0.5
    # what is on disk under a name without its mark would read another's memory
    assert len(made) == len(marks) == 3


def test_a_later_process_compiles_nothing_again(tmp_path):
    for _ in range(2):
        subprocess.run(
            [sys.executable, "-c", PROGRAM], env={**os.environ, "NUMBA_CACHE_DIR": str(tmp_path)}, check=True
        )
    assert len(list(tmp_path.rglob("*.nbc"))) == 1


@njit
def _linearise(data, u, p, work):
    for i in range(2):
        work[0][i] = data[0][i] * u[i] - p
    return max(abs(work[0][0]), abs(work[0][1]))


@njit
def _bordered(data, work, border, target, step, tangent):
    for i in range(3):
        step[i] = border[i] * target
    tangent[0] = data[1]
    return work[0][0]


@njit
def _inspect(data, u, p, work, row):
    row[0] = work[0][0] + p


def kernels():
    return SimpleNamespace(linearise=_linearise, bordered=_bordered, inspect=_inspect)


def test_kernels_called_by_address_do_what_they_do():
    linearise, bordered, inspect = callers().values()

    @njit(**OPTIONS)
    def one_after_the_other(addresses, at, u, p, border, step, tangent, row):
        residual = linearise(addresses, u, p, at)
        sign = bordered(addresses, at, border, 2.0, step, tangent)
        inspect(addresses, u, p, at, row)
        return residual, sign

    u, border = np.array([1.0, 4.0]), np.array([1.0, 2.0, 3.0])
    step, tangent, row = np.zeros(3), np.zeros(3), np.zeros(1)
    data, work = (np.array([3.0, 1.0]), 7.5), (np.zeros(2),)
    kept = Outlined(kernels(), "of_this_test").keep(data, work)
    residual, sign = one_after_the_other(kept.kernels.all, kept.at, u, 0.5, border, step, tangent, row)
    assert (residual, sign) == (3.5, 2.5)  # 3 1 - 0.5 and 4 - 0.5
    assert step.tolist() == [2.0, 4.0, 6.0] and tangent[0] == 7.5 and row[0] == 3.0


def test_what_is_kept_is_found_again_and_never_taken_for_another():
    own = Outlined(kernels(), "of_this_test")
    data, work = (np.ones(2), 1.0), (np.zeros(2),)
    kept = own.keep(data, work)
    assert own.keep(data, work) is kept
    other = own.keep((np.ones(2), 1.0), work)
    assert other is not kept and other.kernels is kept.kernels and other.at != kept.at
    assert own.keep((np.ones((2, 2)), 1.0), work).kernels is not kept.kernels
    assert own.keep(("a name", 1.0), work) is None
    same = kernels()
    assert outlined(same, "one") is outlined(kernels(), "one") is not outlined(same, "two")


def test_arguments_of_other_types_are_refused():
    @njit
    def twice(number):
        return 2.0 * number

    address, call = address_of(twice, NUMBER), caller(NUMBER, NUMBER)

    @njit
    def right(at, number):
        return call(at, number)

    assert right(address, 4.0) == 8.0
    with pytest.raises(TypingError, match="in place of"):
        right(address, 4)
    assert address_of(twice, WHOLE) != address  # the same function for other types
