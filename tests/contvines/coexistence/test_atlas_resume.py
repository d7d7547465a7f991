"""Coexisting cycles are roots of their own; an atlas that ended after a write, the first, the last or between, run again, gives the atlas of a run left alone."""

import shutil

import numpy as np
import pytest

import contvines as cv
from contvines.graph.persistence import same_graph
from contvines.store import Store

pytestmark = pytest.mark.slow


def atlas(journal):
    """x -> x + p sin(2 pi x)/8 on the line: every half-integer attracts, every integer repels: each is a root of its own."""
    problem = cv.MapProblem(lambda x, p: x + p * np.sin(2 * np.pi * x) / 8, [0.5], 1.0)
    population = problem.population(box=[(0.0, 3.0)])
    return cv.atlas(population, within=(0.5, 1.5), values=2, starts=64, scan=2, depth=0, journal=journal)


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
    assert alone.finished
    assert sorted({round(float(b.points[0, 0]), 9) for b in alone}) == [0.5, 1.5, 2.5]
    for value in {a.value for a in alone.attractors}:
        here = [a for a in alone.attractors if a.value == value]
        assert sum(a.share for a in here) == pytest.approx(1.0)
        assert sorted(a.branch for a in here) == sorted(alone.branches)
        for a in here:
            assert a.share == pytest.approx(1 / 3, abs=0.05 if a.starts == 64 else 0.1)  # by symmetry

    for end in {*ends[::3], ends[-1]}:
        last = end == ends[-1]
        with cv.resume(end / path.name) as journal:
            assert journal.finished == last
            if not last:
                assert same_graph(atlas(journal), alone)
                assert journal.finished
        assert same_graph(cv.load(end / path.name, problems=False), alone)
        assert [file.name for file in end.iterdir()] == [path.name]
