"""Tuples handed to compiled code once; see also `test_aims.py`."""

import os
import subprocess
import sys

PROGRAM = """
import numpy as np
from contvines.continuation.binding import OPTIONS
from contvines.continuation.kept import Keeper
assert Keeper(lambda unpack, mark: abs, OPTIONS, "of_this_test").keep((np.zeros(2), 0.5))[0] is abs
"""


def test_a_later_process_compiles_nothing_again(tmp_path):
    for _ in range(2):
        subprocess.run(
            [sys.executable, "-c", PROGRAM], env={**os.environ, "NUMBA_CACHE_DIR": str(tmp_path)}, check=True
        )
    assert len(list(tmp_path.rglob("*.nbc"))) == 1
