"""A run from Python, interrupted anywhere and run again with the same journal, gives the graph of a run left alone."""

import threading

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import contvines as cv
from contvines.graph.persistence import same_graph
from contvines.store import Store

pytestmark = pytest.mark.slow


def run(journal=None):
    """The logistic map's fixed point and its cascade, which begins at r = 3."""
    problem = cv.MapProblem(lambda x, r: r * x * (1 - x), [0.6], 2.5)
    return cv.diagram(problem, within=(2.0, 3.56), depth=3, journal=journal)


@pytest.fixture(scope="module")
def alone():
    graph = run()
    assert min(p.value for p in graph.of_kind("period-doubling")) == pytest.approx(3.0, abs=1e-10)
    return graph


def test_interrupted_at_every_record(tmp_path, alone, monkeypatch):
    path = tmp_path / "r.vines"
    record = Store.record
    interruptions = 0

    def once(self, key, content):
        record(self, key, content)
        raise KeyboardInterrupt

    monkeypatch.setattr(Store, "record", once)
    while True:
        with cv.resume(path) as journal:
            before = journal.records
            try:
                graph = run(journal)
            except KeyboardInterrupt:
                interruptions += 1
                assert journal.records == before + 1
                assert not journal.finished
            else:
                assert journal.finished
                break
    assert interruptions > 10
    assert same_graph(graph, alone)
    assert same_graph(cv.load(path, problems=False), alone)


def test_two_runs_at_once_on_one_file(tmp_path, alone):
    path = tmp_path / "two.vines"
    cv.resume(path).close()
    graphs = []

    def work():
        with cv.resume(path) as journal:
            graphs.append(run(journal))

    threads = [threading.Thread(target=work) for _ in range(2)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert [same_graph(g, alone) for g in graphs] == [True, True]
    assert same_graph(cv.load(path, problems=False), alone)


numbers = (
    st.floats(allow_nan=True, allow_infinity=True) | st.integers(-(2**53), 2**53) | st.booleans() | st.none()
)
scalars = st.recursive(
    numbers | st.text(), lambda inner: st.lists(inner) | st.dictionaries(st.text(), inner), max_leaves=8
)
shapes = st.lists(st.integers(0, 4), min_size=0, max_size=3).map(tuple)
arrays = st.builds(
    lambda shape, seed, kind: (
        np.random.default_rng(seed).standard_normal(shape).astype(kind) if shape else np.array(1.5)
    ),
    shapes,
    st.integers(0, 99),
    st.sampled_from(["f8", "c16", "i8", "?"]),
)


@settings(max_examples=60)
@given(content=st.dictionaries(st.text(), scalars | arrays, max_size=5), key=st.text())
def test_whatever_is_recorded_is_recalled(tmp_path_factory, content, key):
    path = tmp_path_factory.mktemp("store") / "x.vines"
    with Store.create(path, "f") as store:
        store.record(key, content)
    with Store.open(path) as store:
        again = store.recall(key)
    assert again is not None
    assert again.keys() == content.keys()
    for name, value in content.items():
        if isinstance(value, np.ndarray):
            assert (again[name].dtype, again[name].shape) == (value.dtype, value.shape)
            assert again[name].tobytes() == value.tobytes()
        else:
            assert repr(again[name]) == repr(value)


def test_a_branch_that_dies_at_its_start_leaves_no_file(tmp_path):
    """u = p solves the equation at p = 0 and nowhere else can it be computed."""
    problem = cv.AlgebraicProblem(
        lambda u, p: u - p if p == 0.0 else u * np.nan,
        [0.0],
        0.0,
        jacobian=lambda u, p: [[1.0]],
        derivative=lambda u, p: [-1.0],
    )
    with (
        pytest.raises(ValueError, match="ends at its first point"),
        cv.resume(tmp_path / "x.vines") as journal,
    ):
        cv.diagram(problem, within=(-1.0, 1.0), journal=journal)
    assert not list(tmp_path.iterdir())
