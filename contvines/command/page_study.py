"""A study whose machine is declared on a page: `[model] name = "file.py:machine"`, a file beside the study.

The page is Python and is run when the study is read: the user has named it. It lies in the study's folder or below, so that a study runs
nothing that has not come with it.
"""

from pathlib import Path
from typing import Annotated, Any

from pydantic import ConfigDict, Field, ValidationError

from contvines.command.own_code import own_code
from contvines.command.schema import (
    AtlasSection,
    ChartSection,
    ContinueSection,
    Section,
    SurveySection,
    SweepSection,
)
from contvines.command.sentences import sentences_of, together
from contvines.shared.near_names import did_you_mean


class PageSection(Section):
    """`[model]`: the page and object; other keys override the page's parameters."""

    model_config = ConfigDict(extra="allow", frozen=True, strict=True, allow_inf_nan=False)
    name: str


class PageStart(Section):
    """`[start]`: the word may be left out (the attractor from rest is taken); further keys are parameters."""

    model_config = ConfigDict(extra="allow", frozen=True, strict=True, allow_inf_nan=False)
    word: str | None = None
    periods: Annotated[int, Field(ge=1, le=4096)] = 1
    guess: list[list[float]] | None = None
    state: dict[str, float] | None = None


class PageStudyFile(Section):
    model: PageSection
    start: PageStart = PageStart()
    continue_: Annotated[ContinueSection, Field(alias="continue")]
    sweep: SweepSection = SweepSection()
    atlas: AtlasSection = AtlasSection()
    chart: ChartSection | None = None
    survey: SurveySection = SurveySection()


def is_page(data: dict[str, Any]) -> bool:
    """Whether a study names a page of Python as its machine."""
    model = data.get("model")
    name = model.get("name") if isinstance(model, dict) else None
    return isinstance(name, str) and ".py" in name


def _intervals(file: PageStudyFile) -> list[tuple[str, str, tuple[float, float]]]:
    """(section, parameter, interval) of every parameter that the study varies."""
    found = [("continue", file.continue_.parameter, file.continue_.within)]
    if file.chart is not None and file.chart.within is not None:
        found.append(("chart", file.chart.parameter, file.chart.within))
    return [(section, name, (float(low), float(high))) for section, name, (low, high) in found]


def check(data: dict[str, Any], path: Path) -> dict[str, Any]:
    """The fields of a `Study` from a study that names a page; runs the page.

    Raises
    ------
    ValueError
        With one sentence per value that cannot be used.
    """
    from orbits.machines.page.loading import load_page

    try:
        file = PageStudyFile.model_validate(data)
    except ValidationError as error:
        raise ValueError(together(sentences_of(error, data))) from None
    page, _, name = file.model.name.partition(":")
    if not name:
        raise ValueError(
            f'[model] name = {file.model.name!r} names a page but no machine on it; "{page}:machine" would do.'
        )
    machine = load_page(own_code(path, page, f"[model] name = {file.model.name!r}"), name)
    given: dict[str, float] = {}
    wrong: list[str] = []
    for section, extra in (("model", file.model.model_extra), ("start", file.start.model_extra)):
        for key, value in (extra or {}).items():
            if key not in machine.parameters:
                wrong.append(
                    f"[{section}] {key} = {value!r}: the machine {machine.name!r} has no such parameter"
                    f"{did_you_mean(key, machine.parameters)}; it has {', '.join(machine.parameters)}."
                )
            elif isinstance(value, bool) or not isinstance(value, (int, float)):
                wrong.append(f"[{section}] {key} = {value!r} is not a number.")
            else:
                given[key] = float(value)
    go = file.continue_
    low, high = go.within
    if go.parameter not in machine.parameters:
        wrong.append(
            f"[continue] parameter = {go.parameter!r}: the machine {machine.name!r} has no such parameter"
            f"{did_you_mean(go.parameter, machine.parameters)}; it has {', '.join(machine.parameters)}."
        )
    elif not low < high:
        wrong.append(f"[continue] within = {go.within!r} is empty or reversed; low < high would do.")
    else:
        first = {**machine.parameters, **given}[go.parameter]
        if not low <= first <= high:
            wrong.append(
                f"[start] {go.parameter} = {first!r} lies outside [continue] within = [{low!r}, {high!r}]; "
                "start inside the interval, or widen it."
            )
    if file.chart is not None and file.chart.parameter not in machine.parameters:
        wrong.append(
            f"[chart] parameter = {file.chart.parameter!r}: the machine {machine.name!r} has no such parameter"
            f"{did_you_mean(file.chart.parameter, machine.parameters)}; it has {', '.join(machine.parameters)}."
        )
    for key in file.start.state or {}:
        if key not in (*machine.states, "phase"):
            wrong.append(f"[start] state has {key!r}; it may have {', '.join((*machine.states, 'phase'))}.")
    if not wrong:
        for section, name, limits in _intervals(file):
            for value in limits:
                try:
                    machine.check_value(name, value)
                except ValueError as error:
                    wrong.append(f"[{section}] within = {list(limits)!r}: {error}.")
        try:
            params = machine.vector(given)
            machine.word(file.start.word or "", params)
        except ValueError as error:
            wrong.append(f"[start] {error}")
    if wrong:
        raise ValueError(together(wrong))
    return {
        "path": path,
        "name": file.model.name,
        "parameters": {**machine.parameters, **given},
        "word": file.start.word,
        "periods": file.start.periods,
        "guess": file.start.guess,
        "parameter": go.parameter,
        "within": (float(low), float(high)),
        "depth": go.depth,
        "virtual": go.virtual,
        "settings": go.model_dump(
            include={"tolerance", "angle", "max_step", "max_points", "max_branches"}, exclude_none=True
        ),
        "sweep": file.sweep,
        "atlas": file.atlas,
        "chart": file.chart,
        "survey": file.survey,
        "bounds": {name: (low, high) for name, (low, high) in go.bounds.items()},
        "kinds": go.kinds,
        "machine": machine,
        "loose": {**machine.parameters, **given},
        "state": file.start.state,
    }
