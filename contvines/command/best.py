"""`contvines survey STUDY.toml --best "lowest worst-case peak" --over half_width`: the best point of a survey, refined to an optimum near it."""

from __future__ import annotations

import itertools
import math
import re
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
import typer

from ..shared.numbers import figures
from ..text_table import fitted
from .frame import draw, tell
from .study_data import Sort, Study
from .survey_study import (
    family_of,
    outcomes_of,
    plan_and_machine,
    units_of,
    ways_of,
)

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from orbits.design import Choice

    from ..survey import Survey

LOW, HIGH = ("lowest", "smallest", "least"), ("highest", "largest", "most")
FILLING = ("worst-case", "worst", "robust", "%", "quantile", "of")  # words without further meaning
NUMBER = re.compile(r"\d+(\.\d+)?")
PEAKS = ("peak", "lower_peak")  # outcomes that are compared with those of other machines
ALONE = ("bare", "tuned")  # these machines: the bare oscillator and a tuned absorber
BESIDE = {
    "peak": ("peak_at",),
    "lower_peak": ("lower_peak_at",),
    "activation": ("activation_from_below", "activation_from_above"),
    "dissipation": ("impact_power", "friction_power"),
    "pumping": ("pumping_time", "pumped_share"),
}
"""Further columns of an outcome, besides or instead of the column with its name."""
FORM = 'for example "lowest worst-case peak", "largest stable_LR" or "lowest 95 % peak"'


class Goal(NamedTuple):
    """The goal of ``--best``: largest or lowest, the quantile over the samples (None: the worst sample), the outcome."""

    largest: bool
    quantile: float | None
    outcome: str

    @property
    def over(self) -> str:
        """The reduction over the samples, in words."""
        return "at worst" if self.quantile is None else f"{100.0 * self.quantile:g} %"


def read_goal(text: str) -> Goal:
    """Parse the text of ``--best``.

    Raises
    ------
    ValueError
        If the text cannot be parsed.
    """
    words = text.replace("%", " % ").split()
    if len(words) < 2 or words[0] not in LOW + HIGH:
        raise ValueError(f"--best {text!r} cannot be read; {FORM}.")
    rest, quantile = words[1:], None
    while rest and ((number := NUMBER.fullmatch(rest[0])) or rest[0] in FILLING):
        if number:
            quantile = float(rest[0]) / 100.0
            if not 0.0 < quantile <= 1.0:
                raise ValueError(
                    f"--best {text!r}: {rest[0]} % is no quantile; expected a number above 0 and at most 100."
                )
        rest = rest[1:]
    if len(rest) != 1:
        raise ValueError(f"--best {text!r} names {'no' if not rest else 'more than one'} outcome; {FORM}.")
    return Goal(words[0] in HIGH, quantile, rest[0])


def check_over(study: Study, over: list[str]) -> None:
    """Check that the parameters to choose are those on the grid of the survey, one or two.

    Raises
    ------
    ValueError
        If they are not.
    """
    axes = list(plan_and_machine(study)[0].axes)
    if over and sorted(over) != sorted(axes):
        raise ValueError(
            f"--over {' '.join(over)}: [survey] vary has {', '.join(axes) or 'nothing'} on a grid, and each of it is chosen; "
            "what is uncertain is sampled (uniform, normal)."
        )
    if len(axes) > 2:
        raise ValueError(f"--over {' '.join(axes)}: one or two parameters can be chosen at a time.")


def asking(study: Study, outcome: str) -> Study:
    """Return the study with an outcome added to those of its survey, unless it is among them."""
    outcomes = study.survey.outcomes
    if outcome.partition(":")[0] in ("stable", "first", "share") or outcome in outcomes:
        return study
    prefixes = tuple(one.replace(":", "_") for one in outcomes if ":" in one)
    if outcome.startswith(prefixes) or any(outcome in BESIDE.get(one, ()) for one in outcomes):
        return study
    return study.having("survey", outcomes=[*outcomes, outcome])


def choose(study: Study, text: str, least: float, found: Survey) -> Choice:
    """Find the optimum near the best point of a survey.

    Parameters
    ----------
    study : Study
    text : str
        Of ``--best``.
    least : float
        Smallest share of the interval in which the response must be known.
    found : Survey
        The survey of the study.

    Raises
    ------
    ValueError
        If the outcome is known for no machine.
    """
    from orbits.design import best

    from ..survey.outcomes import OF_ALL
    from ..survey.work import Job, work

    plan, model = plan_and_machine(study)
    largest, quantile, outcome = goal = read_goal(text)
    if outcome not in found.columns:
        raise ValueError(
            f"--best {text!r}: the survey has no outcome {outcome}; it has {', '.join(found.columns) or 'none'}."
        )
    job = Job(
        family_of(study, model), study.parameter, study.within, tuple(outcomes_of(study)), options=study.options, **ways_of(study),
    )  # fmt: skip

    def evaluate(values: dict[str, float]) -> dict[str, float]:
        row = work(job, 0, values)
        if not row.columns:
            raise ValueError(row.note)
        unknown = outcome in OF_ALL and not row.columns["covered"] >= least
        return {**row.columns, outcome: math.nan} if unknown else row.columns

    heights = found.judged(outcome, largest, quantile, least).ravel()
    if not np.isfinite(heights).any():
        reason = next((str(note) for note in found.notes.ravel() if note), "no machine has a number for it")
        raise ValueError(
            f"--best {text!r}: {outcome} is not known of any machine{' with all its samples' if plan.samples else ''} ({reason}); "
            f"more depth in [continue], or atlas = true in [survey], finds more motions{_in_part(found, goal)}."
        )
    points = [dict(zip(plan.axes, map(float, point))) for point in itertools.product(*plan.axes.values())]
    drawn = [dict(zip(plan.samples, map(float, row))) for row in zip(*plan.samples.values())] or [{}]
    return best(
        evaluate, outcome, {name: (float(values[0]), float(values[-1])) for name, values in plan.axes.items()},
        largest=largest, tolerances=drawn, quantile=quantile, known=list(zip(points, map(float, heights))),
    )  # fmt: skip


def tell_choice(
    study: Study, text: str, covered: float | None, found: Survey, json_: bool, quiet: bool, plot: Path | None
) -> None:
    """Print and draw the choice with its other outcomes; `covered` is `least` of `choose`, by default that of surveys."""
    from ..survey.outcomes import LEAST_SHARE
    from .plot import compared_text, peaks_compared

    goal, least = read_goal(text), LEAST_SHARE if covered is None else covered
    outcome = goal.outcome
    choice, (_, model) = choose(study, text, least, found), plan_and_machine(study)
    units = units_of(study, model)
    solo = outcome in PEAKS and study.sort is Sort.PHYSICAL and "damping" in model.parameter_names
    asked = (model.with_(**choice.values) if solo else model, study.parameter, study.within, ALONE)
    if json_:
        data = {"best": choice.values, outcome: choice.outcome, "others": choice.others}
        if solo:
            data["compared"] = peaks_compared(*asked)
        named = {*choice.values, outcome, *choice.others}
        if shown_units := {name: unit for name, unit in units.items() if name in named}:
            data["units"] = shown_units
        tell(choice, data)
    elif not quiet:
        typer.echo(fitted(_choice_text(choice, goal, found, units, least)))
        if solo:
            typer.echo(fitted(compared_text(*asked)))
    draw(plot, lambda: _picture(found, choice, goal), quiet)


def _in_part(found: Survey, goal: Goal) -> str:
    """Describe the choice if the median of the known shares were accepted (option ``--covered``); empty if nothing is known."""
    share = found["covered"].min(axis=-1) if found.plan.samples else found["covered"]
    if not np.isfinite(share).any():
        return ""
    least = math.floor(1000.0 * float(np.nanmedian(share))) / 1000.0
    try:
        point, number = found.best(goal.outcome, goal.largest, goal.quantile, least)
    except ValueError:
        return ""
    place = ", ".join(f"{name} = {figures(value)}" for name, value in point.items())
    return f"; with --covered {least:g}, which takes what is known of the better half, it is {figures(number)} at {place}"


def _picture(found: Survey, choice: Choice, goal: Goal) -> Figure:
    """Return the survey's picture with the choice, and the points tried in the search, marked."""
    from ..plots.legends import place_legend
    from ..shared.figures import styled

    figure, names = found.plot(goal.outcome, legend=False), list(found.plan.axes)
    axes, red = figure.axes[0], "#b5121b"
    places = [(*(values[name] for name in names), outcome)[:2] for values, outcome in choice.tried]
    label = f"tried, {goal.over}" if len(names) == 1 else "tried"
    axes.plot(*zip(*sorted(places)), ".", color=red, label=label)
    x, y, *_ = *(choice.values[name] for name in names), choice.outcome
    axes.plot(x, y, "*", color=red, markersize=14, markeredgecolor="white", label="chosen")
    with styled():
        place_legend(axes, (), True, True, usual="inside" if len(names) == 1 else "below")
    return figure


def _choice_text(choice: Choice, goal: Goal, found: Survey, units: dict[str, str], least: float) -> str:
    """Describe the choice: its values, its outcome, and its other outcomes with their ranges over the survey."""

    def text(name: str, value: float) -> str:
        return f"{figures(value)} {units.get(name, '')}".rstrip() if np.isfinite(value) else "-"

    lines = [f"{name} = {text(name, value)}" for name, value in choice.values.items()]
    extent = f"the {'largest' if goal.largest else 'lowest'} that was found"
    samples = found.plan.shape[-1] if found.plan.samples else 1
    if samples > 1:
        over = goal.over if goal.quantile is None else f"in {goal.over} of the cases"
        extent = f"{over} over {samples} samples, {extent}"
    lines.append(f"{goal.outcome} = {text(goal.outcome, choice.outcome)}, {extent}")
    unknown = np.count_nonzero(~np.isfinite(found.known(goal.outcome, least)))
    if unknown:
        lines.append(
            f"left out: {unknown} of {len(found.plan)} machines of which {goal.outcome} is not known; the column note says why"
        )
    if choice.others:
        middle = ", medians of the samples" if found.plan.samples else ""
        lines += ["", f"there, beside it{middle} (and from ... to ... over the survey):"]
        for name, value in choice.others.items():
            column = found.columns.get(name, np.array([]))
            finite = column[np.isfinite(column)]
            span = f"  ({figures(finite.min())} to {figures(finite.max())})" if finite.size else ""
            lines.append(f"  {name} = {text(name, value)}{span}")
    return "\n".join(lines)
