"""`contvines survey STUDY.toml --best "lowest worst-case peak" --over half_width`: a survey, its best, and the optimum near it."""

from __future__ import annotations

import math
import re
from pathlib import Path
from typing import TYPE_CHECKING

import typer

from contvines.command.frame import draw, tell
from contvines.command.study_data import Sort, Study
from contvines.shared.number_text import figures
from contvines.text_table import fitted

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from orbits.design import Choice

    from ..survey import Survey

LOW, HIGH = ("lowest", "smallest", "least"), ("highest", "largest", "most")
WORST = ("worst-case", "worst", "robust")
PEAKS = ("peak", "lower_peak")  # outcomes that the oscillator alone, and a tuned absorber, have too
ALONE = ("bare", "tuned")  # what is told beside them
FORM = 'for example "lowest worst-case peak", "largest stable_LR" or "lowest 95 % peak"'


def read_wish(text: str) -> tuple[bool, float | None, str]:
    """Whether the largest is wanted, which quantile over the samples (None: the worst), and of which outcome.

    Raises
    ------
    ValueError
        If the text cannot be read.
    """
    words = text.replace("%", " % ").split()
    if len(words) < 2 or words[0] not in LOW + HIGH:
        raise ValueError(f"--best {text!r} cannot be read; {FORM}.")
    rest, quantile = words[1:], None
    while (rest and rest[0] in (*WORST, "%", "quantile", "of")) or (
        rest and re.fullmatch(r"\d+(\.\d+)?", rest[0])
    ):
        if re.fullmatch(r"\d+(\.\d+)?", rest[0]):
            quantile = float(rest[0]) / 100.0
            if not 0.0 < quantile <= 1.0:
                raise ValueError(
                    f"--best {text!r}: {rest[0]} % is no quantile; expected a number above 0 and at most 100."
                )
        rest = rest[1:]
    if len(rest) != 1:
        raise ValueError(f"--best {text!r} names {'no' if not rest else 'more than one'} outcome; {FORM}.")
    return words[0] in HIGH, quantile, rest[0]


def choose(
    study: Study,
    text: str,
    over: list[str],
    covered: float | None,
    target: Path,
    workers: int | None,
    cluster: str | None,
    plot: Path | None,
    json_: bool,
    fresh: bool,
    quiet: bool,
) -> None:
    """Survey, choose, refine, and print the other outcomes."""
    import dataclasses

    from contvines.command.compare import compared_text, peaks_compared
    from contvines.command.survey_study import (
        family_of,
        options_of,
        outcomes_of,
        plan_and_machine,
        units_of,
        ways_of,
    )
    from contvines.command.surveying import surveyed
    from contvines.survey.outcomes import KNOWN, OF_ALL
    from contvines.survey.work import Job, work
    from orbits.design import best

    largest, quantile, outcome = read_wish(text)
    least = KNOWN if covered is None else covered
    plan, model = plan_and_machine(study)
    over = over or list(plan.axes)
    if sorted(over) != sorted(plan.axes):
        raise ValueError(
            f"--over {' '.join(over)}: [survey] vary has {', '.join(plan.axes) or 'nothing'} on a grid, and each of it is chosen; "
            "what is uncertain is sampled (uniform, normal)."
        )
    if len(over) > 2:
        raise ValueError(f"--over {' '.join(over)}: one or two parameters can be chosen at a time.")
    if outcome.partition(":")[0] not in ("stable", "first", "share") and outcome not in study.survey.outcomes:
        known = {"peak_at": "peak", "lower_peak_at": "lower_peak"}
        if known.get(outcome, outcome) not in study.survey.outcomes and not _comes(outcome, study):
            survey = study.survey.model_copy(update={"outcomes": [*study.survey.outcomes, outcome]})
            study = dataclasses.replace(study, survey=survey)
    found = surveyed(study, target, workers, cluster, fresh, quiet)
    if outcome not in found.columns:
        raise ValueError(
            f"--best {text!r}: the survey has no outcome {outcome}; it has {', '.join(found.columns) or 'none'}."
        )
    job = Job(
        family_of(study, model), study.parameter, study.within, tuple(outcomes_of(study)), options=options_of(study), **ways_of(study),
    )  # fmt: skip

    def evaluate(values: dict[str, float]) -> dict[str, float]:
        row = work(job, 0, values)
        if not row.columns:
            raise ValueError(row.note)
        unknown = outcome in OF_ALL and not row.columns["covered"] >= least
        return {**row.columns, outcome: math.nan} if unknown else row.columns

    drawn = [{}]
    if plan.samples:
        drawn = [{name: float(v[i]) for name, v in plan.samples.items()} for i in range(plan.shape[-1])]
    known = _known(found, outcome, largest, quantile, least)
    if not any(math.isfinite(number) for _, number in known):
        why = next((str(note) for note in found.notes.ravel() if note), "no machine has a number for it")
        raise ValueError(
            f"--best {text!r}: {outcome} is not known of any machine{' with all its samples' if plan.samples else ''} ({why}); "
            f"more depth in [continue], or atlas = true in [survey], finds more motions{_in_part(found, outcome, largest, quantile)}."
        )
    limits = {name: (float(plan.axes[name][0]), float(plan.axes[name][-1])) for name in plan.axes}
    choice = best(
        evaluate, outcome, limits, largest=largest, tolerances=drawn, quantile=quantile, known=known
    )
    units = units_of(study, model)
    alone = outcome in PEAKS and study.sort is Sort.PHYSICAL and "damping" in model.parameter_names
    chosen = model.with_(**choice.values) if alone else model
    if json_:
        names = {*choice.values, *choice.others, outcome}
        said = {name: unit for name, unit in units.items() if name in names}
        about = {
            "best": choice.values,
            outcome: choice.outcome,
            "others": choice.others,
            **({"compared": peaks_compared(chosen, study.parameter, study.within, ALONE)} if alone else {}),
            **({"units": said} if said else {}),
        }
        tell(choice, about)
    elif not quiet:
        typer.echo(
            fitted(_choice_text(choice, outcome, found, units, _wish(largest, quantile, len(drawn)), least))
        )
        if alone:
            typer.echo(fitted(compared_text(chosen, study.parameter, study.within, ALONE)))
    if plot is not None:
        figure = found.plot(outcome)
        _draw(figure, choice, list(plan.axes), "at worst" if quantile is None else f"{100.0 * quantile:g} %")
        draw(plot, lambda: figure, quiet)


def _comes(outcome: str, study: Study) -> bool:
    """Whether an outcome of the study has this column beside its own name."""
    belongs = {"activation": ("activation_from_below", "activation_from_above"), "dissipation": ("impact_power", "friction_power"), "pumping": ("pumping_time", "pumped_share")}  # fmt: skip
    prefix = [said.replace(":", "_") for said in study.survey.outcomes if ":" in said]
    return any(outcome in belongs.get(said, ()) for said in study.survey.outcomes) or any(
        outcome.startswith(start) for start in prefix
    )


def _known(
    found: Survey, outcome: str, largest: bool, quantile: float | None, covered: float
) -> list[tuple[dict[str, float], float]]:
    """The survey's points and their outcomes over the samples; no number where one of these is not known."""
    import itertools

    import numpy as np

    value = found.known(outcome, covered) * (-1.0 if largest else 1.0)
    if found.plan.samples:
        value = value.max(axis=-1) if quantile is None else np.quantile(value, quantile, axis=-1)
    points = itertools.product(*found.plan.axes.values())
    flat = value.ravel() * (-1.0 if largest else 1.0)
    return [(dict(zip(found.plan.axes, map(float, point))), float(v)) for point, v in zip(points, flat)]


def _in_part(found: Survey, outcome: str, largest: bool, quantile: float | None) -> str:
    """What would be chosen if the machines that are known best counted as known; empty where nothing is known."""
    import numpy as np

    share = found["covered"].min(axis=-1) if found.plan.samples else found["covered"]
    if not np.isfinite(share).any():
        return ""
    least = math.floor(1000.0 * float(np.nanmedian(share))) / 1000.0
    try:
        point, number = found.best(outcome, largest, quantile, least)
    except ValueError:
        return ""
    place = ", ".join(f"{name} = {figures(value)}" for name, value in point.items())
    return f"; with --covered {least:g}, which takes what is known of the better half, it is {figures(number)} at {place}"


def _wish(largest: bool, quantile: float | None, samples: int) -> str:
    """What was looked for, in words."""
    which = "largest" if largest else "lowest"
    if samples == 1:
        return f"the {which} that was found"
    over = "at worst" if quantile is None else f"in {100.0 * quantile:g} % of the cases"
    return f"{over} over {samples} samples, the {which} that was found"


def _draw(figure: Figure, choice: Choice, names: list[str], over: str) -> None:
    """Mark the choice in the survey's picture, and what was tried on the way to it."""
    axes = figure.axes[0]
    red = "#b5121b"
    if len(names) == 1:
        tried = sorted((values[names[0]], outcome) for values, outcome in choice.tried)
        axes.plot(*zip(*tried), ".", color=red, label=f"tried, {over}")
    else:
        axes.plot(*zip(*([values[name] for name in names] for values, _ in choice.tried)), ".", color=red, label="tried")  # fmt: skip
    place = [choice.values[name] for name in names]
    axes.plot(
        place[0],
        place[1] if len(place) == 2 else choice.outcome,
        "*",
        color=red,
        markersize=14,
        markeredgecolor="white",
        label="chosen",
    )
    if axes.get_legend() is not None:
        axes.legend()


def _choice_text(
    choice: Choice, outcome: str, found: Survey, units: dict[str, str], wish: str, covered: float
) -> str:
    """The choice, and what it costs: the other outcomes beside the best that each could be on the grid."""
    import numpy as np

    def shown(name: str, value: float) -> str:
        return f"{figures(value)} {units.get(name, '')}".rstrip() if np.isfinite(value) else "-"

    lines = [f"{name} = {shown(name, value)}" for name, value in choice.values.items()]
    lines.append(f"{outcome} = {shown(outcome, choice.outcome)}, {wish}")
    unknown = np.count_nonzero(~np.isfinite(found.known(outcome, covered)))
    if unknown:
        lines.append(
            f"left out: {unknown} of {len(found.plan)} machines of which {outcome} is not known; the column note says why"
        )
    if choice.others:
        middle = ", medians of the samples" if found.plan.samples else ""
        lines += ["", f"there, beside it{middle} (and from ... to ... over the survey):"]
        for name, value in choice.others.items():
            column = found.columns.get(name)
            known = column[np.isfinite(column)] if column is not None else np.array([])
            span = f"  ({figures(known.min())} to {figures(known.max())})" if known.size else ""
            lines.append(f"  {name} = {shown(name, value)}{span}")
    return "\n".join(lines)
