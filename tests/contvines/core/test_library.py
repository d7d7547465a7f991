"""Which core computes: chosen, and as a fallback."""

import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from contvines.core import build
from contvines.core.records import block, pack

ROOT = Path(__file__).parents[3]
ASK = "from contvines.core.library import native; print(native())"


def run(code, **environment):
    return subprocess.run(
        [sys.executable, "-c", code], cwd=ROOT, env=os.environ | environment, capture_output=True, text=True
    )


def test_the_reference_core_is_chosen_without_a_word():
    done = run(ASK, CONTVINES_CORE="reference")
    assert done.stdout.strip() == "False" and not done.stderr


def test_an_unknown_choice_is_refused():
    assert "CONTVINES_CORE='fast' is unknown" in run(ASK, CONTVINES_CORE="fast").stderr


@pytest.mark.parametrize("content", [None, b"no library"])
def test_a_library_that_cannot_be_loaded_is_said_in_one_line(tmp_path, content):
    path = build.path_of("baseline", tmp_path)
    if content is not None:
        path.write_bytes(content)
    code = f"from contvines.core import library; library.path_of = lambda v: __import__('pathlib').Path({str(path)!r}); "
    done = run(code + "print(library.native(), library.native())", CONTVINES_CORE="")
    assert done.stdout.strip() == "False False"
    assert len(done.stderr.splitlines()) == 1 and str(path) in done.stderr


@pytest.mark.skipif(
    len(build.variants()) < 2 or run(ASK, CONTVINES_CORE="avx2").stderr != "", reason="one variant only"
)
def test_without_the_faster_variant_the_other_one_computes(tmp_path):
    path = build.path_of("avx2", tmp_path)
    code = (
        "from contvines.core import library; import pathlib; there = library.path_of; "
        f"library.path_of = lambda v: pathlib.Path({str(path)!r}) if v == 'avx2' else there(v); print(library.variant())"
    )
    done = run(code, CONTVINES_CORE="")
    assert done.stdout.strip() == "baseline"
    assert len(done.stderr.splitlines()) == 1 and str(path) in done.stderr


INTERRUPTED = """
import signal, sys
from contvines.core.library import library, native

calls, most, interrupted = 0, 0, 0

def trace(frame, event, argument):
    global calls
    calls += 1
    if calls == most:
        signal.raise_signal(signal.SIGINT)

while True:
    calls, most = 0, most + 1 + most // 4
    try:
        sys.setprofile(trace)
        library()
        sys.setprofile(None)
    except KeyboardInterrupt:
        interrupted += 1
    sys.setprofile(None)
    library_is = native()
    if calls < most:
        break
    library.cache_clear()
print(interrupted > 10, library_is)
"""


def test_interrupted_at_any_call_of_its_loading_it_is_loaded_by_the_next():
    """Nothing stays half registered: after an interrupt the process uses the same core as one left alone."""
    assert run(INTERRUPTED).stdout.split() == ["True", run(ASK).stdout.strip()]


def test_a_compiler_that_fails_is_quoted(tmp_path):
    with pytest.raises(build.NotBuilt, match="core.cpp"):
        build.build(tmp_path, ["false"])


def test_a_struct_holds_numbers_and_places_of_arrays():
    values = np.arange(3.0)
    made = pack(3, 0.5, values)
    assert made[0] == 3 and made.view(float)[1] == 0.5 and made[2] == values.ctypes.data


def test_a_block_holds_its_arrays():
    memory, (one, two) = block((7, 0.25), ((2, 3), (4,)))
    one[:], two[:] = 1.0, 2.0
    assert memory.view(np.int64)[0] == 7 and memory[1] == 0.25
    assert memory.view(np.int64)[2:4].tolist() == [one.ctypes.data, two.ctypes.data]
    assert memory[4:].tolist() == [1.0] * 6 + [2.0] * 4


@pytest.mark.parametrize("wrong", [np.zeros((4, 4)).T[:2], np.zeros(3, np.float32)])
def test_an_array_of_another_kind_is_refused(wrong):
    with pytest.raises(TypeError, match="cannot be handed"):
        pack(wrong)
