"""Which core computes: chosen, and as a fallback."""

import _ctypes
import os
import subprocess
import sys
from pathlib import Path

import pytest

from contvines.core import build

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


def cut_short():
    return build.path_of("baseline").read_bytes()[:100_000]


def of_somebody_else():
    return Path(_ctypes.__file__).read_bytes()


@pytest.mark.parametrize("content", [None, lambda: b"no library", cut_short, of_somebody_else])
def test_a_library_that_cannot_be_loaded_is_said_in_one_line(tmp_path, content):
    path = build.path_of("baseline", tmp_path)
    if content is not None:
        path.write_bytes(content())
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


def test_a_compiler_that_does_not_know_the_flags_is_passed_over(tmp_path, monkeypatch):
    old = tmp_path / "c++"
    old.write_text("#!/bin/sh\nexit 1\n")
    old.chmod(0o755)
    monkeypatch.setenv("PATH", str(tmp_path))
    monkeypatch.delenv("CXX", raising=False)
    assert build.compiler() is None
