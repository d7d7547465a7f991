"""Which core computes: chosen, and as a fallback."""

import os
import subprocess
import sys
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pytest

from contvines.core import build
from contvines.core.records import record, structure

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


def test_a_build_elsewhere_gives_libraries_of_these_sources(tmp_path):
    if build.compiler() is None:
        pytest.skip("no compiler")
    made = build.build(tmp_path)
    assert [path.exists() for path in made] == [True] * len(build.variants())
    assert build.up_to_date(tmp_path)


def test_a_compiler_that_fails_is_quoted(tmp_path):
    with pytest.raises(build.NotBuilt, match="core.cpp"):
        build.build(tmp_path, ["false"])


class Content(NamedTuple):
    count: int
    share: float
    values: np.ndarray


def test_a_record_holds_the_numbers_and_the_place_of_the_array():
    values = np.arange(3.0)
    made = record(structure(Content), Content(3, 0.5, values))
    assert (made.count, made.share, made.values) == (3, 0.5, values.ctypes.data)


@pytest.mark.parametrize("wrong", [np.zeros((4, 4)).T[:2], np.zeros(3, np.float32)])
def test_an_array_of_another_kind_is_refused(wrong):
    with pytest.raises(TypeError, match="cannot be handed"):
        record(structure(Content), Content(3, 0.5, wrong))
