"""The budget of an atlas: what most starts reach comes first, what is left out is said, results depend on nothing else."""

import pytest

import contvines as cv
from contvines.graph.persistence import same_graph
from tests.machines import ABSORBER

pytestmark = pytest.mark.slow


def logistic():
    problem = cv.MapProblem(lambda x, r: r * x * (1.0 - x), [0.6], 2.6)
    return problem.population(box=[(0.01, 0.99)])


def motions(graph):
    return {(a.value, a.word, a.kind) for a in graph.attractors}


def made(budget=10**9, journal=None, population=None):
    return cv.atlas(
        population or logistic(),
        within=(2.55, 3.4),
        values=4,
        starts=4,
        scan=1,
        depth=1,
        budget=budget,
        journal=journal,
    )


@pytest.fixture(scope="module")
def whole():
    return made()


@pytest.fixture(scope="module")
def least():
    return made(1)


def test_a_budget_is_kept_and_what_it_leaves_out_is_said(whole, least):
    work = whole.settings["work"]
    assert whole.complete and work > 0
    enough = made(work + 1)
    assert enough.complete and motions(enough) == motions(whole) and enough.settings["work"] == work
    assert len({a.value for a in least.attractors}) == 1  # the first of the four given values
    assert least.finished and not least.complete and "raise budget" in least.message
    for what, count in (("given values", 3), ("branches that leave others", 1)):
        assert least.settings["left"][what] == count and f"{what} ({count})" in least.message
    # the fixed point 1 - 1 / r doubles at r = 3, and its 2-cycle is left
    (doubling,) = least.of_kind("period-doubling")
    assert doubling.value == pytest.approx(3.0) and "budget = 1" in " ".join(doubling.remarks)
    budget = least.settings["work"] + 1
    part = made(budget)
    assert not part.complete and budget <= part.settings["work"] < work
    assert motions(least) <= motions(part) <= motions(whole)


def test_a_larger_budget_goes_on_from_what_was_computed(tmp_path, whole, least):
    """A file keeps all pieces of work until nothing is left out; the result is that of one run with the larger budget."""
    records, asked = [], []
    for budget in (1, least.settings["work"] + 1, 10**9):
        with cv.resume(tmp_path / "a.vines") as journal:
            before, record = journal.records, journal.record
            journal.record = lambda key, values, record=record: asked.append(key) or record(key, values)
            graph = made(budget, journal)
            records.append((before, journal.records))
        assert graph.finished and graph.stopped == (budget < 10**9)
    assert [before for before, _ in records[1:]] == [after for _, after in records[:-1]]
    assert 0 < records[0][1] < records[1][1] and records[2][1] == 0
    assert len(set(asked)) == len(asked)  # nothing was computed twice
    assert same_graph(graph, whole)


def test_the_price_of_integrated_flights_counts(whole, monkeypatch):
    """At twice the price the same budget allows half the work."""
    dear = logistic()
    monkeypatch.setattr(type(dear), "price", 2.0)
    assert made(population=dear).settings["work"] == pytest.approx(2 * whole.settings["work"], abs=1)


def test_the_limit_at_which_branches_of_roots_wait_is_said():
    """The logistic map: zero and 1 - 1/r, of which doublings leave at r = 3 that are not followed."""
    problem = cv.MapProblem(lambda x, p: [p * x[0] * (1 - x[0])], [0.5], 2.5)
    graph = cv.atlas(problem, within=(2.4, 3.55), settings={"max_branches": 1})
    assert "stopped at max_branches = 1" in graph.message and not graph.complete


CASCADING = ABSORBER.changed(restitution=0.8564451, friction=0.1418559, gravity=0.4553905)


def test_a_motion_between_the_given_values_that_all_starts_reach():
    """All of 30 starts reach LRLt, k = 1, at amplitude 1.50963; its branch hangs together with no other motion of the given values."""
    there = 1.50963
    population = CASCADING.population("amplitude")
    (reached,), _, _ = population.settle(population.starts(30, 1, there), there)
    assert (reached.word, reached.periods) == ("LRLt", 1)

    def atlas(scan):
        return cv.atlas(
            CASCADING, over="amplitude", within=(1.4, 1.7), values=[1.46, 1.66], starts=8, scan=scan, depth=0, budget=2000
        )  # fmt: skip

    holding = [
        b for b in atlas(4) if b.real and any(low < there < high for low, high in b.stable_intervals())
    ]
    assert [(b.description["word"], b.description["periods"]) for b in holding] == [("LRLt", 1)]
    assert any(low < there < high for low, high in atlas(0).settings["unknown"])
