"""`contvines recommend`: theory against closed forms, the choice against brute force, its answer on a page."""

import json
import math
import re
import shutil
from dataclasses import replace
from functools import partial

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from contvines.command import recommending
from contvines.command.recommendation import Place, Recommendation
from contvines.command.recommending import recommend
from contvines.command.study import check_study, read_study
from contvines.export import json_text
from contvines.report.answer import BROWSERS, Answer, print_page, set_answer
from contvines.shared.figures import new_figure
from orbits.attractors.sweeping import sweep
from orbits.design.references import first_clearance
from tests.contvines.studies import EXAMPLES, data

MACHINE = (EXAMPLES / "design" / "machine.toml").read_text()
SURVEY = """
within = ["7.5 Hz", "8.5 Hz"]
[survey]
vary.half_width = { within = ["60 mm", "100 mm"], count = 5 }
vary.restitution = { uniform = [0.6, 0.8] }
samples = 2
"""


def test_theory_begins_with_the_linear_peak():
    """At resonance the base moves the oscillator by base_amplitude/(2 D), the absorber held fast: 2 mm/0.02."""
    model = check_study(data(MACHINE)).model
    first = first_clearance(model, model.vector())
    assert first.linear_peak == pytest.approx(100.0, rel=0.01)
    assert first.entered == first.linear_peak and first.safe <= first.widest
    assert 0.0 < first.remaining < first.linear_peak
    wider = model.with_(half_width=40.0)  # no statement about the oscillator depends on the cavity it has
    assert first_clearance(wider, wider.vector()).widest == pytest.approx(first.widest, rel=1e-12)


# ---------------------------------------------------------------- what is told
UNKNOWN = Recommendation(
    "a.toml", "a", "half_width", "frequency", (7.0, 9.0), {"half_width": "mm", "peak": "mm"}, None, 20.0, (math.nan, math.nan), 0.05, {},
    [Place(58.0, math.nan, math.nan, math.nan, 2, 3, "no stable motion is known")], {}, math.nan, math.nan, {}, {}, None, None,
    unknown=["the response at half_width = 58"],
)  # fmt: skip


def test_what_is_not_known_stays_unknown_in_a_file():
    again = Recommendation.from_dict(json.loads(json_text(UNKNOWN.to_dict())))
    assert repr(again) == repr(UNKNOWN)
    assert "No half width can be recommended" in str(again) and "not known: the response" in str(again)


def test_a_larger_response_by_simulation_is_the_one_that_counts():
    place = Place(58.0, 61.0, 60.0, 60.0, 2, 0)
    found = replace(UNKNOWN, value=58.0, places=[place], tolerance=(58.0, 58.0), checked=(61.0, 70.0))
    assert found.rows[0][:2] == ("recommended", "at least 70 mm")
    assert found.rows[1][1] == "61 mm"
    assert "70 mm" in found.sentences[0] and "not known" in found.sentences[0]
    found = replace(found, checked=(61.0, 61.2))
    assert found.rows[0][:2] == ("recommended", "61 mm")


# ---------------------------------------------------------------- the search, on responses that are drawn
@pytest.fixture
def work(monkeypatch):
    """The work of a recommendation before its first look; a function of value and sample takes the place of diagrams."""

    def begun(response, cost, samples):
        work = object.__new__(recommending._Work)
        work.name, work.samples, work.drawn = "gap", samples, {"restitution": np.arange(float(samples))}
        work.rows, work.places, work.pace, work.round, work.integrated = {}, {}, None, 0, False
        work.cost, work.tell, work.asked = cost, lambda _: None, 0

        def looked(plan):
            work.asked += len(plan)
            drawn = plan.samples.get("restitution", [0.0])
            rows = np.array(
                [[response(value, int(sample)) for sample in drawn] for value in plan.axes["gap"]]
            )
            return recommending._Responses(
                rows, rows, np.where(np.isnan(rows), "not known", "").astype(object)
            )

        work._computed = looked
        return work

    return begun


@pytest.mark.parametrize("seed", range(20))
def test_a_value_that_is_good_for_the_studys_own_machine_alone_does_not_hide_a_better_one(
    seed, work, monkeypatch
):
    """In the end no value that was looked at has a lower worst response, but for those whose own response costs as much."""
    cost, values = 0.05, np.round(np.linspace(10.0, 20.0, 81), 3)
    table = dict(zip(values, 1.0 + np.random.default_rng(seed).random((81, 4))))
    work = work(lambda value, sample: table[value][sample], cost, 4)
    monkeypatch.setattr(recommending, "_tidy", lambda value: float(values[np.abs(values - value).argmin()]))
    work.note(Place(v, *[table[v][0]] * 3, 0, 1) for v in values[::10])
    best = min(work.places.values(), key=lambda place: place.worst)
    work.later_look([best.value], best.value)
    best = work.passed_over(work.places[best.value])
    assert best.worst == table[best.value].max()
    for value in work.places:
        assert table[value].max() >= best.worst or table[value][0] >= (1.0 - cost) * best.worst


@pytest.mark.parametrize("seed", range(20))
def test_machines_that_are_left_out_change_neither_the_choice_nor_the_tolerance(seed, work):
    """Beside the worst of all samples at all values; a few are not known."""
    generator, cost, values = np.random.default_rng(seed), 0.1, np.round(np.linspace(10.0, 20.0, 7), 3)
    table = 1.0 + 0.01 * generator.uniform(0, 2) * (values[:, None] - 15.0) ** 2
    table = table + 0.1 * generator.random((7, 4))
    table[generator.random(table.shape) < 0.02] = np.nan
    work = work(lambda value, sample: table[np.searchsorted(values, value), sample], cost, 4)
    work.later_look(values, 15.0)
    best, worst = work.best(), table.max(axis=1)
    lowest = np.nanargmin(worst)
    assert best is not None and (best.worst, best.value) == (worst[lowest], values[lowest])
    bad = np.flatnonzero(~(worst <= (1.0 + cost) * best.worst))
    low, high = max(bad[bad < lowest], default=-1) + 1, min(bad[bad > lowest], default=7) - 1
    assert work.tolerance(best) == (values[low], values[high])
    assert work.asked <= table.size


@pytest.mark.parametrize(("jump", "chosen"), [(15.0, 15.3), (14.0, 15.06), (math.pi, 15.06)])
def test_a_choice_keeps_off_a_jump(jump, chosen, work):
    """Of a response that grows from 15.06 on either way, and below a jump is twice as large; looked at every 0.02."""
    work = work(lambda x, _: 2.5 if x < jump else 1.0 + 0.05 * abs(x - 15.06), 0.05, 1)
    values = np.round(np.arange(13.06, 17.0, 0.5), 3).tolist()
    work.later_look(values, 15.06)
    best, jumps = work.away_from_jumps(work.best())
    assert best.value == pytest.approx(chosen, abs=0.05)
    assert bool(jumps) == (jump >= values[0])
    for one in jumps[:1]:
        assert one.response == 2.5 and one.beyond in values and jump - 0.05 < one.at < jump


# ---------------------------------------------------------------- the answer on paper
@pytest.mark.skipif(not any(map(shutil.which, BROWSERS)), reason="no browser that prints")
def test_a_page_is_printed_on_paper(tmp_path):
    page = tmp_path / "a.html"
    page.write_text(Answer("A study", "The answer.", ["A sentence."], tables=[("T", [("a", "1 mm")])]).page())
    print_page(page, tmp_path / "a.pdf")
    assert (tmp_path / "a.pdf").read_bytes().startswith(b"%PDF")


def test_without_a_browser_the_answer_is_set_on_two_sheets(tmp_path):
    figure = new_figure(figsize=(9.0, 3.4))
    rows = [
        ("what", "1 mm", "a remark that is long enough to go on in a second line of its column, " * 2)
    ] * 14
    tables = [("One", rows), ("Two", rows)]
    said = "A study", "The answer costs $5 and 100 %.", ["A sentence. " * 20]
    answer = Answer(*said, [(figure, "A picture.")], tables, [("Assumed", ["this", "that"])])
    set_answer(answer, tmp_path / "a.pdf")
    text = (tmp_path / "a.pdf").read_bytes()
    assert text.startswith(b"%PDF") and len(re.findall(rb"/Type /Page\b", text)) == 2


# ---------------------------------------------------------------- against brute force
@pytest.mark.slow
@pytest.mark.long
def test_the_choice_is_that_of_brute_force_and_interrupted_work_goes_on(run, tmp_path, monkeypatch):
    path = tmp_path / "machine.toml"
    path.write_text(MACHINE[: MACHINE.index("within")] + SURVEY)
    kept = [tmp_path / f"machine-recommend.json.{k}.unfinished" for k in range(9)]  # as the command has it

    def interrupted(text):
        if "round 2" in text:
            raise KeyboardInterrupt

    asked = partial(recommend, path, workers=1, journal=lambda k: kept[k])
    with pytest.raises(KeyboardInterrupt):
        asked(tell=interrupted)
    before = kept[1].read_bytes()
    assert len(before.splitlines()) == 6  # a head and five machines
    found = asked()
    assert kept[1].read_bytes() == before
    assert found.value is not None and found.chosen is not None
    assert Recommendation.from_dict(json.loads(json.dumps(found.to_dict()))) == found
    assert found.tolerance[0] <= found.value <= found.tolerance[1]
    # brute force: from the motions that simulations up and down meet, and from themselves
    assert found.checked is not None
    by, simulated = found.checked
    assert simulated == pytest.approx(by, rel=0.01)
    model = read_study(path).model
    for place in (p for p in found.places if p.samples == 1):
        rows = sweep(model.with_(half_width=place.value), "frequency", np.linspace(7.8, 8.2, 41))
        met = max(row.measures["max_abs_q1"] for row in rows)
        assert met <= 1.01 * place.worst or math.isnan(place.worst)
    told = run.ok("recommend machine.toml --plot choice.png")
    assert (tmp_path / "choice.png").exists()
    assert "Recommended: half width" in told and "tuned absorber of the same mass" in told
    run.ok("report machine-recommend.json")
    page = (tmp_path / "machine-recommend.html").read_text()
    assert "<svg" in page and "tuned absorber of the same mass" in page and "3.2 kg" in page
    assert page.count("not known") <= 1 + len(found.unknown)  # nothing is hidden, nothing is dumped
    monkeypatch.setattr("contvines.report.answer.BROWSERS", ())
    assert "a.pdf (set by matplotlib, as no browser" in run.ok("report machine-recommend.json --pdf a.pdf")


def recommended(folder, within, gaps):
    """What is recommended for the machine whose wall is lined with rubber."""
    shutil.copy(EXAMPLES / "machines" / "rubber_wall.py", folder)
    (folder / "study.toml").write_text(
        f'[model]\nname = "rubber_wall.py:machine"\n[continue]\nparameter = "frequency"\nwithin = {within}\n'
        f"[survey]\nsamples = 1\nvary.gap = {gaps}\n"
    )
    return recommend(folder / "study.toml", workers=1)


def rubber(gap, frequency, start):
    """The largest displacements of masses before walls lined with rubber in the long run; starts are columns."""

    def laws(t, y):
        x, v = y.reshape(2, -1)
        press = 30.0 * (x - gap) + 1.5 * v
        force = np.where((x > gap) & (press > 0.0), press, 0.0)
        return np.concatenate([v, 0.5 * np.cos(frequency * t) - 0.04 * v - x - force])

    period = 2 * np.pi / frequency
    run = solve_ivp(laws, (0, 120 * period), np.ravel(start), rtol=1e-8, atol=1e-10, max_step=0.05)
    return run.y[: len(run.y) // 2, run.t > 110 * period].max(axis=1)


@pytest.mark.slow
def test_a_wall_lined_with_rubber(tmp_path):
    """Nearer walls quiet it more; the response at the choice is that of scipy's integration of the page's equations."""
    found = recommended(tmp_path, [1.44, 1.5], [0.4, 0.42, 0.44, 0.46, 0.48])
    assert found.at_end and "absorber" not in str(found)
    assert found.value == 0.4 and found.checked[1] == pytest.approx(found.checked[0], rel=0.01)
    (late,) = rubber(0.4, 1.5, [[0.5], [1.0]])  # of the large motion, with which the small one coexists
    peak = max(curve.y[-1] for curve in found.curves if curve.name == "stable" and curve.x[-1] == 1.5)
    assert late == pytest.approx(peak, rel=1e-3)


@pytest.mark.slow
def test_the_jump_beside_a_choice_is_that_of_scipy(tmp_path):
    """Above a gap the large motion is gone from the interval; below it, it is twice as large as what is left."""
    found = recommended(tmp_path, [1.47, 1.6], "{ within = [0.79, 0.85], count = 5 }")
    (jump,) = found.jumps
    told = f"{found.value - jump.at:.3g} lower it jumps: {jump.response:.4g} at {jump.beyond:.4g}."
    assert told in str(found)
    assert 1.02 * jump.at <= found.value + 1e-3 and found.tolerance[0] > jump.at
    starts = np.array([[1.1, 0.5, 0.8, 0.0], [0.0, 1.0, 0.8, 0.0]])
    gaps = np.array([jump.beyond, jump.at, 1.01 * jump.at, found.value])
    every = rubber(np.repeat(gaps, 4), 1.47, np.tile(starts, 4))
    before, at, after, chosen = every.reshape(4, 4).max(axis=1)
    assert before == pytest.approx(jump.response, rel=0.03) and at > 0.97 * before and after < 0.5 * before
    assert chosen == pytest.approx(found.chosen.worst, rel=0.01)
