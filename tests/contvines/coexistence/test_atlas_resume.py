"""An atlas that ended after a write, the first, the last or between, run again, gives the atlas of a run left alone."""

import shutil

import numpy as np
import pytest

import contvines as cv
from contvines.graph.persistence import same_graph
from contvines.store import Store

pytestmark = pytest.mark.slow


def atlas(journal):
    """x -> x + p sin(2 pi x)/8: each half-integer attracts and hangs together with no other, so each is a root."""
    problem = cv.MapProblem(lambda x, p: x + p * np.sin(2 * np.pi * x) / 8, [0.5], 1.0)
    population = problem.population(box=[(0.0, 3.0)])
    return cv.atlas(population, within=(0.5, 1.5), values=2, starts=32, scan=2, depth=1, journal=journal)


def test_ended_after_some_of_its_writes(tmp_path, monkeypatch):
    path, ends = tmp_path / "a.vines", []

    def kept_as_a_kill_leaves_it(method):
        def wrapped(self, *arguments):
            method(self, *arguments)
            here = tmp_path / str(len(ends))
            here.mkdir()
            for file in tmp_path.glob("a.vines*"):
                shutil.copy(file, here)
            ends.append(here)

        return wrapped

    with monkeypatch.context() as patch, cv.resume(path) as journal:
        for name in ("checkpoint", "record"):
            patch.setattr(Store, name, kept_as_a_kill_leaves_it(getattr(Store, name)))
        alone = atlas(journal)
    assert alone.finished and len(alone.branches) >= 3
    for value in {a.value for a in alone.attractors if a.starts}:  # every start reaches something
        assert sum(a.share for a in alone.attractors if a.value == value and a.starts) == pytest.approx(1.0)

    for end in {*ends[::3], ends[-1]}:
        last = end == ends[-1]
        with cv.resume(end / path.name) as journal:
            assert journal.finished == last
            if not last:
                assert same_graph(atlas(journal), alone)
                assert journal.finished
        assert same_graph(cv.load(end / path.name, problems=False), alone)
        assert [file.name for file in end.iterdir()] == [path.name]
