"""What compiles here makes what numba's own compiler makes."""

import numpy as np
import pytest
from numba import config, float64, njit
from numba.core.compiler import Flags

from contvines_ground.parts import MAKER, whole

pytestmark = pytest.mark.skipif(
    bool(config.DISABLE_JIT) or not MAKER, reason="nothing is compiled, or by numba's own"
)


def largest(values):
    found = values[0] * values[0]
    for i in range(1, values.shape[0]):
        found = max(found, values[i] * values[i])
    return found


def test_the_same_numbers_as_with_numba_itself():
    values = np.linspace(-1.5, 1.0, 7)
    assert whole()(largest)(values) == njit(largest)(values) == 2.25
    assert whole()(largest)(np.arange(4)) == 9  # integers


def test_a_signature_is_compiled_at_once():
    double = whole(float64(float64))(lambda x: 2.0 * x)
    assert double.signatures == [(float64,)]
    assert double(3) == 6.0


def test_what_is_remembered_of_a_call_is_not_taken_for_other_options():
    """`max` of two numbers is compiled with the options of its caller, whichever was compiled before."""
    made = [
        whole(fastmath=fast, error_model="numpy")(lambda a, b: max(a, b) + max(b, a))
        for fast in (True, False, True, False)
    ]
    for function in made:
        assert function(1.0, 2.0) == 4.0
    for function, fast in zip(made, (True, False, True, False), strict=True):
        (code,) = function.inspect_llvm().values()
        assert (" fast " in code) == fast


def test_settled_options_are_equal_to_those_they_were_made_from():
    from contvines_ground.compiler import _Given

    flags = Flags()
    flags.error_model = "numpy"
    given = _Given(flags)
    settled = given.copy()
    assert settled == flags and flags == settled and hash(settled) == hash(flags)
    assert settled == given.copy() and settled != Flags()
    changed = settled.copy()
    changed.nrt = True
    assert changed != settled and settled == flags
