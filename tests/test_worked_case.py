"""The worked case of `examples/design`: its study is read, a small survey of it is made, and a choice follows."""

import json
from contextlib import nullcontext
from dataclasses import replace
from pathlib import Path

import pytest

from contvines.command import best
from contvines.command.best import read_goal
from contvines.command.cli import main
from contvines.command.compose import machine
from contvines.command.study import read_study
from contvines.command.survey_study import plan_and_machine
from orbits.attractors.sweeping import sweep
from orbits.design import choice
from orbits.settings import DESIGNING
from tests.contvines.studies import table

pytestmark = pytest.mark.slow

STUDY = Path(__file__).parents[1] / "examples" / "design" / "absorber.toml"


def run(*words):
    with pytest.raises(SystemExit) as ended:
        main(["survey", "case.toml", "--workers", "1", *words])
    assert not ended.value.code


def changed(text, *pairs):
    """A study with lines in the place of others."""
    for old, new in pairs:
        assert old in text
        text = text.replace(old, new)
    Path("case.toml").write_text(text)


def test_the_plan_of_the_case():
    plan, machine = plan_and_machine(read_study(STUDY))
    assert plan.shape == (7, 6) and plan.axes["half_width"].tolist() == [8, 10, 12, 14, 16, 18, 20]
    assert plan.samples["restitution"].min() >= 0.5 and plan.samples["friction"].max() <= 0.3
    assert machine.units["half_width"] == "mm"


@pytest.mark.long
def test_the_choice_is_at_worst_as_good_as_the_worst_of_every_sample_of_the_survey(
    tmp_path, monkeypatch, capsys
):
    monkeypatch.chdir(tmp_path)
    changed(
        STUDY.read_text(),
        ("count = 7", "count = 3"),
        ("samples = 6", "samples = 2"),
        ("depth = 2", "depth = 0"),
        ("vary.friction = { uniform = [0.05, 0.3] }\n", ""),
        ('"lower_peak", "covered", "stable:LR"', '"stable:LtLtLR"'),
        ('within = ["8 mm", "20 mm"]', 'within = ["13 mm", "15 mm"]'),
        # beside the resonance every motion is periodic, so that all machines are known
        ('within = ["7 Hz", "9 Hz"]', 'within = ["8.1 Hz", "9 Hz"]'),
        ("7.9 Hz", "8.2 Hz"),
    )
    words = ("--best", "lowest worst-case peak", "--over", "half_width")
    choose, made = best.choose, []

    def chosen_once(*asked):
        made.append(made[0] if made else choose(*asked))
        return made[0]

    monkeypatch.setattr(best, "choose", chosen_once)
    monkeypatch.setattr(choice, "DESIGNING", replace(DESIGNING, accuracy=0.02))  # of the interval
    run(*words, "--json", "--plot", "best.png")
    about = json.loads(capsys.readouterr().out)
    rows, worst = table("case-survey.csv"), {}
    for row in rows:
        place = float(row["half_width [mm]"])
        worst[place] = max(worst.get(place, 0.0), float(row["peak [mm]"]))
    assert len(rows) == 6 and about["peak"] <= min(worst.values())
    assert 13.0 <= about["best"]["half_width"] <= 15.0
    run(*words)
    said = capsys.readouterr().out
    assert "at worst over 2 samples, the lowest that was found" in said
    assert "_from = -" in said and "nan" not in said  # a motion that none of the samples has


@pytest.mark.parametrize(
    ("text", "wish"),
    [
        ("lowest worst-case peak", (False, None, "peak")),
        ("largest stable_LR", (True, None, "stable_LR")),
        ("lowest 95 % peak", (False, 0.95, "peak")),
        ("lowest 95% quantile of peak", (False, 0.95, "peak")),
        ("best peak", None),
        ("lowest", None),
        ("lowest 120 % peak", None),
        ("lowest peak please now", None),
    ],
)
def test_wishes(text, wish):
    with nullcontext() if wish else pytest.raises(ValueError, match=r"^--best"):
        assert read_goal(text) == wish


def test_from_which_shaking_on_is_where_simulated_impacts_begin_and_end(tmp_path, monkeypatch, capsys):
    """More and less shaking than the survey says, simulated: from rest, and carried on from a motion with impacts."""
    monkeypatch.chdir(tmp_path)
    changed((STUDY.parent / "shaking.toml").read_text(), ("samples = 6", "samples = 1"))
    run("--json")
    (row,) = json.loads(capsys.readouterr().out)["rows"]
    below, above = (row[f"activation_from_{side}"] for side in ("below", "above"))
    model = machine(read_study("case.toml")).with_(
        **{name: row[name] for name in ("restitution", "friction")}
    )

    def impacts(*values):
        rows = sweep(model, "base_amplitude", list(values), transient=1000)
        return [row.measures["impacts_per_period"] for row in rows]

    assert impacts(0.99 * below) == [0.0] and impacts(1.01 * below) != [0.0]
    busy, calm = impacts(1.2 * below, 0.5 * (above + below), 1.02 * above, 0.97 * above)[-2:]
    assert busy == 2.0 and calm == 0.0
