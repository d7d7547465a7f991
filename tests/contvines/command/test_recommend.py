"""`contvines recommend`: refusals, theory against closed forms, the choice against brute force."""

import json
import math
import re
import shutil
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from contvines.command import recommending
from contvines.command.recommendation import Place, Recommendation
from contvines.command.recommending import recommend
from contvines.command.study import read_study
from contvines.export import json_text
from contvines.report.answer import BROWSERS, Answer, print_page
from orbits.attractors.sweeping import sweep
from orbits.design.references import first_clearance

MODEL = """
units = "si"
[model]
name = "coupled"
oscillator_mass = "3.2 kg"
natural_frequency = "8 Hz"
damping_ratio = 0.01
absorber_mass = "32 g"
half_width = "20 mm"
restitution = 0.7
friction = 0.155
base_amplitude = "2 mm"
[continue]
parameter = "frequency"
within = ["7.5 Hz", "8.5 Hz"]
"""
SURVEY = """
[survey]
vary.half_width = { within = ["60 mm", "100 mm"], count = 5 }
vary.restitution = { uniform = [0.6, 0.8] }
samples = 2
"""


def written(tmp_path, text):
    path = tmp_path / "machine.toml"
    path.write_text(text)
    return path


def test_theory_begins_with_the_linear_peak(tmp_path):
    """At resonance the base moves the oscillator by base_amplitude/(2 D), the absorber held fast: 2 mm/0.02."""
    model = read_study(written(tmp_path, MODEL)).model
    first = first_clearance(model, model.vector())
    assert first.linear_peak == pytest.approx(100.0, rel=0.01)
    assert first.entered == first.linear_peak and first.safe <= first.widest
    assert 0.0 < first.remaining < first.linear_peak
    wider = model.with_(half_width=40.0)  # no statement about the oscillator depends on the cavity it has
    assert first_clearance(wider, wider.vector()).widest == pytest.approx(first.widest, rel=1e-12)


@pytest.mark.parametrize(
    ("survey", "says"),
    [
        ('[survey]\nvary.half_width = ["60 mm", "80 mm"]\nvary.friction = [0.1, 0.2]', "half_width and friction on a grid: contvines recommend chooses one"),
        ('[survey]\nvary.half_width = { within = [60, 80], count = 3 }', "vary.half_width.within[0] = 60 has no unit"),
    ],
)  # fmt: skip
def test_refusals(run, tmp_path, survey, says):
    status, _, err = run("recommend", written(tmp_path, MODEL + survey))
    assert status == 1 and says in err
    (tmp_path / "machine-recommend.json").write_text("{}")
    status, _, err = run("recommend", written(tmp_path, MODEL + SURVEY))
    assert status == 1 and "this is not a file of contvines recommend" in err


def test_what_is_not_known_stays_unknown_in_a_file():
    unknown = Place(58.0, math.nan, math.nan, math.nan, 2, 3, "no stable motion is known")
    found = Recommendation(
        "a.toml", "a", "half_width", "frequency", (7.0, 9.0), {"half_width": "mm"}, None, 20.0, (math.nan, math.nan), 0.05, {}, [unknown], {},
        math.nan, math.nan, {}, {}, None, None, unknown=["the response at half_width = 58"],
    )  # fmt: skip
    again = Recommendation.from_dict(json.loads(json_text(found.to_dict())))
    assert repr(again) == repr(found)
    assert "No half width can be recommended" in str(again) and "not known: the response" in str(again)


def test_a_larger_response_by_simulation_is_the_one_that_counts():
    place = Place(58.0, 61.0, 60.0, 60.0, 2, 0, "")
    found = Recommendation(
        "a.toml", "a", "half_width", "frequency", (7.0, 9.0), {"half_width": "mm", "peak": "mm"}, 58.0, 20.0, (58.0, 58.0), 0.05, {}, [place], {},
        math.nan, math.nan, {}, {}, (61.0, 70.0), None,
    )  # fmt: skip
    assert found.rows[0][:2] == ("recommended", "at least 70 mm")
    assert found.rows[1][1] == "61 mm"
    assert "70 mm" in found.sentences[0] and "not known" in found.sentences[0]
    found = replace(found, checked=(61.0, 61.2))
    assert found.rows[0][:2] == ("recommended", "61 mm")


def work_on(cost, samples):
    """The work of a recommendation before its first look; nothing is computed."""
    work = object.__new__(recommending._Work)
    work.name, work.samples, work.drawn = "gap", samples, {"restitution": np.arange(float(samples))}
    work.rows, work.places, work.pace, work.round, work.integrated = {}, {}, None, 0, False
    work.cost, work.tell = cost, lambda _: None
    return work


def drawn_responses(monkeypatch, work, values, table):
    """Responses of a table take the place of diagrams; how many were asked for each time."""
    looked = []

    def responses(plan):
        looked.append(len(plan))
        rows = table[np.searchsorted(values, plan.axes["gap"])][:, plan.samples["restitution"].astype(int)]
        return recommending._Looked(rows, rows, np.where(np.isnan(rows), "not known", "").astype(object))

    monkeypatch.setattr(work, "_looked", responses)
    return looked


@pytest.mark.parametrize("seed", range(20))
def test_a_value_that_is_good_for_the_studys_own_machine_alone_does_not_hide_a_better_one(seed, monkeypatch):
    """Drawn responses: in the end no value that was looked at has a lower worst response, but for those whose own response costs as much."""
    generator, cost = np.random.default_rng(seed), 0.05
    values = np.round(np.linspace(10.0, 20.0, 81), 3)
    table = 1.0 + generator.random((81, 4))
    work = work_on(cost, 4)
    drawn_responses(monkeypatch, work, values, table)
    monkeypatch.setattr(recommending, "_tidy", lambda value: float(values[np.abs(values - value).argmin()]))
    own, worst = dict(zip(values, table[:, 0])), dict(zip(values, table.max(axis=1)))
    work.note(Place(v, own[v], own[v], own[v], 0, 1) for v in values[::10])
    best = min(work.places.values(), key=lambda place: place.worst)
    work.later_look([best.value], best.value)
    best = work.passed_over(work.places[best.value])
    assert best.worst == worst[best.value]
    looked = work.places.values()
    assert all(worst[p.value] >= best.worst or own[p.value] >= (1.0 - cost) * best.worst for p in looked)


@pytest.mark.parametrize("seed", range(20))
def test_machines_that_are_left_out_change_neither_the_choice_nor_the_tolerance(seed, monkeypatch):
    """Beside the worst of all samples at all values, drawn; a few are not known."""
    generator, cost = np.random.default_rng(seed), 0.1
    values = np.round(np.linspace(10.0, 20.0, 7), 3)
    table = (
        1.0 + 0.01 * generator.uniform(0, 2) * (values[:, None] - 15.0) ** 2 + 0.1 * generator.random((7, 4))
    )
    table[generator.random(table.shape) < 0.02] = np.nan
    work = work_on(cost, 4)
    looked = drawn_responses(monkeypatch, work, values, table)
    work.later_look(values, 15.0)
    best, worst = work.best(), table.max(axis=1)
    assert best is not None and best.worst == np.nanmin(worst) and best.value == values[np.nanargmin(worst)]
    good = worst <= (1.0 + cost) * best.worst
    low = high = int(np.nanargmin(worst))
    while low > 0 and good[low - 1]:
        low -= 1
    while high < 6 and good[high + 1]:
        high += 1
    assert work.tolerance(best) == (values[low], values[high])
    assert sum(looked) <= table.size


@pytest.mark.parametrize(("jump", "chosen"), [(15.0, 15.3), (14.0, 15.06), (math.pi, 15.06)])
def test_a_choice_keeps_off_a_jump(jump, chosen, monkeypatch):
    """Of a response that grows from 15.06 on either way, and below a jump is twice as large; looked at every 0.02."""
    work = work_on(0.05, 1)

    def response(x):
        return 2.5 if x < jump else 1.0 + 0.05 * abs(x - 15.06)

    def looked(plan):
        return recommending._Looked(
            *(np.array([[f(x)] for x in plan.axes["gap"]], kind) for f, kind in columns)
        )

    columns = [(response, float), (response, float), (lambda x: "", object)]
    monkeypatch.setattr(work, "_looked", looked)
    values = np.round(np.arange(13.06, 17.0, 0.5), 3).tolist()
    work.later_look(values, 15.06)
    best, jumps = work.away_from_jumps(work.best())
    assert best.value == pytest.approx(chosen, abs=0.05)
    if jump < values[0]:
        assert not jumps
    else:
        assert jumps[0].response == 2.5 and jumps[0].beyond in values and jump - 0.05 < jumps[0].at < jump


@pytest.mark.skipif(not any(map(shutil.which, BROWSERS)), reason="no browser that prints")
def test_a_page_is_printed_on_paper(tmp_path):
    page = tmp_path / "a.html"
    page.write_text(Answer("A study", "The answer.", ["A sentence."], tables=[("T", [("a", "1 mm")])]).page())
    print_page(page, tmp_path / "a.pdf")
    assert (tmp_path / "a.pdf").read_bytes().startswith(b"%PDF")


def test_without_a_browser_the_answer_is_set_on_two_sheets(tmp_path):
    from contvines.plots.figures import new_figure
    from contvines.report.answer import set_answer

    figure = new_figure(figsize=(9.0, 3.4))
    rows = [
        ("what", "1 mm", "a remark that is long enough to go on in a second line of its column, " * 2)
    ] * 14
    answer = Answer(
        "A study",
        "The answer costs $5 and 100 %.",
        ["A sentence. " * 20],
        [(figure, "A picture.")],
        [("One", rows), ("Two", rows)],
        [("Assumed", ["this", "that"])],
    )
    set_answer(answer, tmp_path / "a.pdf")
    text = (tmp_path / "a.pdf").read_bytes()
    assert text.startswith(b"%PDF") and len(re.findall(rb"/Type /Page\b", text)) == 2


@pytest.mark.slow
@pytest.mark.long
def test_the_choice_is_that_of_brute_force_and_interrupted_work_goes_on(run, tmp_path, monkeypatch):
    path = written(tmp_path, MODEL + SURVEY)
    kept = [
        tmp_path / f"machine-recommend.json.{k}.unfinished" for k in range(9)
    ]  # the command's, which goes on from them

    def interrupted(text):
        if "round 2" in text:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        recommend(path, workers=1, journal=lambda k: kept[k], tell=interrupted)
    assert len(kept[1].read_text().splitlines()) == 6  # a head and five machines
    before = kept[1].read_bytes()
    found = recommend(path, workers=1, journal=lambda k: kept[k])
    assert kept[1].read_bytes() == before
    assert found.value is not None and found.chosen is not None
    assert Recommendation.from_dict(json.loads(json.dumps(found.to_dict()))) == found
    low, high = found.tolerance
    assert low <= found.value <= high
    # brute force: from the motions that simulations up and down meet, and from themselves
    assert found.checked is not None
    by, simulated = found.checked
    assert simulated == pytest.approx(by, rel=0.01)
    model = read_study(path).model
    for place in (p for p in found.places if p.samples == 1):
        grid = np.linspace(7.8, 8.2, 41)
        rows = sweep(model.with_(half_width=place.value), "frequency", grid)
        met = max(row.measures["max_abs_q1"] for row in rows)
        assert met <= 1.01 * place.worst or math.isnan(place.worst)
    assert run("recommend", path, "-q")[0] == 0
    status, told, _ = run("recommend", path, "--plot", "choice.png")
    assert status == 0
    assert (
        "Recommended: half width" in told
        and "tuned absorber of the same mass" in told
        and (tmp_path / "choice.png").exists()
    )
    assert run("report", "machine-recommend.json")[0] == 0
    page = (tmp_path / "machine-recommend.html").read_text()
    assert "<svg" in page and "tuned absorber of the same mass" in page and "3.2 kg" in page
    monkeypatch.setattr("contvines.report.answer.BROWSERS", ())
    status, out, _ = run("report", "machine-recommend.json", "--pdf", "a.pdf")
    assert status == 0 and "a.pdf (set by matplotlib, as no browser" in out
    assert page.count("not known") <= 1 + len(found.unknown)  # nothing is hidden, nothing is dumped


@pytest.mark.slow
def test_a_wall_lined_with_rubber(tmp_path):
    """Nearer walls quiet it more; the response at the choice is that of scipy's integration of the page's equations."""
    shutil.copy(Path(__file__).parents[3] / "examples" / "machines" / "rubber_wall.py", tmp_path)
    (tmp_path / "study.toml").write_text(
        '[model]\nname = "rubber_wall.py:machine"\n[continue]\nparameter = "frequency"\nwithin = [1.44, 1.5]\n'
        "[survey]\nsamples = 1\nvary.gap = [0.4, 0.42, 0.44, 0.46, 0.48]\n"
    )
    found = recommend(tmp_path / "study.toml", workers=1)
    assert found.at_end and "absorber" not in str(found)
    assert found.value == 0.4 and found.checked[1] == pytest.approx(found.checked[0], rel=0.01)
    (late,) = rubber(0.4, 1.5, [[0.5], [1.0]])  # of the large motion, with which the small one coexists
    peak = max(curve.y[-1] for curve in found.curves if curve.name == "stable" and curve.x[-1] == 1.5)
    assert late == pytest.approx(peak, rel=1e-3)


@pytest.mark.slow
def test_the_jump_beside_a_choice_is_that_of_scipy(tmp_path):
    """Above a gap the large motion is gone from the interval; below it, it is twice as large as what is left."""
    shutil.copy(Path(__file__).parents[3] / "examples" / "machines" / "rubber_wall.py", tmp_path)
    (tmp_path / "study.toml").write_text(
        '[model]\nname = "rubber_wall.py:machine"\n[continue]\nparameter = "frequency"\nwithin = [1.47, 1.6]\n'
        "[survey]\nsamples = 1\nvary.gap = { within = [0.79, 0.85], count = 5 }\n"
    )
    found = recommend(tmp_path / "study.toml", workers=1)
    (jump,) = found.jumps
    assert f"{found.value - jump.at:.3g} lower it jumps: {jump.response:.4g} at {jump.beyond:.4g}." in str(
        found
    )
    assert 1.02 * jump.at <= found.value + 1e-3 and found.tolerance[0] > jump.at
    starts = np.array([[1.1, 0.5, 0.8, 0.0], [0.0, 1.0, 0.8, 0.0]])
    gaps = np.array([jump.beyond, jump.at, 1.01 * jump.at, found.value])
    every = rubber(np.repeat(gaps, 4), 1.47, np.tile(starts, 4))
    before, at, after, chosen = every.reshape(4, 4).max(axis=1)
    assert before == pytest.approx(jump.response, rel=0.03) and at > 0.97 * before and after < 0.5 * before
    assert chosen == pytest.approx(found.chosen.worst, rel=0.01)


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
