"""A checked study, the checks of what several fields say together, and sentences for what is wrong: the field, the value and a way out."""

from __future__ import annotations

import json
import os
import re
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field, fields, replace
from enum import Enum, auto
from pathlib import Path
from typing import TYPE_CHECKING, Any, get_args

from pydantic import ValidationError
from pydantic.fields import FieldInfo
from pydantic_core import ErrorDetails

from orbits.machines.names import PAGES

from ..shared.files import digest_of
from ..shared.near_names import did_you_mean
from .schema import (
    AtlasSection,
    ChartSection,
    MachineSections,
    RandomSection,
    S,
    Section,
    Sections,
    SurveySection,
    SweepSection,
    kind_of,
)

if TYPE_CHECKING:
    from orbits.machines.parameters import Table

    from ..bifurcation.kind import Kind


SETTINGS = {"tolerance", "angle", "max_step", "max_points", "max_branches", "max_unknowns"}
SHOWN = 60  # letters of a word that a refusal repeats
UNION = re.compile(r"constrained-\w+|(list|dict)\[.*\]")  # how pydantic names types in the place of an error
MOST = 20  # sentences in one refusal
SECTIONS = {
    "model": 'name = "absorber" and its parameters',
    "continue": 'what to vary and where, for example parameter = "amplitude", within = [0.2, 1.3]',
}
WRONG = {
    "float_type": "is not a number",
    "int_type": "is not a whole number",
    "string_type": "is not text",
    "bool_type": "is not true or false",
    "finite_number": "is not a finite number",
    "greater_than": "is out of range",
    "greater_than_equal": "is out of range",
    "less_than": "is out of range",
    "less_than_equal": "is out of range",
}
"""What is wrong with a value, by the type of pydantic's error."""


class Sort(Enum):
    """What a study continues."""

    CATALOGUE = auto()  # a built-in machine in its own numbers
    PHYSICAL = auto()  # a built-in machine in kilograms and hertz
    PAGE = auto()  # a machine that a file beside the study declares
    FLOW = auto()  # differential equations of a file beside the study


@dataclass(frozen=True)
class Study:
    """A checked study.

    Attributes
    ----------
    path : Path of the TOML file.
    sort : whose study it is.
    name : of the machine or flow, as the study has it.
    parameters : every parameter at the start, by name.
    parameter, within, depth, virtual : the continuation.
    settings : the fields of `contvines.continuation.settings.Settings` that the study sets.
    bounds : (low, high) of measures at which branches end; infinite where there is none.
    kinds : file and name of the user's own kinds of special points; `all_kinds` are these and the built-in ones, `kinds_digest` is the file's.
    word, periods, guess : the first orbit.
    state : where the motion begins from which the first orbit is found, if no word is given: by name, of a flow in the order of its states.
    model : the machine; None for a flow.
    flow : the flow; None for a machine.
    loose : parameters that are given to the machine with each orbit.
    box : ranges of many starts of a flow.
    sweep, atlas, chart, survey, random : the sections of these names.
    text : the TOML text.
    conditions : values of what parameters depend on; their tables : of parameters over them.
    """

    path: Path
    sort: Sort
    name: str
    parameters: dict[str, float]
    parameter: str
    within: tuple[float, float]
    depth: int
    virtual: bool
    settings: dict[str, Any]
    bounds: dict[str, tuple[float, float]]
    kinds: str | None
    word: str | None = None
    periods: int = 1
    guess: list[list[float]] | None = None
    state: dict[str, float] | list[float] | None = None
    model: Any = None
    flow: Any = None
    loose: dict[str, float] = field(default_factory=dict)
    box: list[list[float]] | None = None
    sweep: SweepSection = field(default_factory=SweepSection)
    atlas: AtlasSection = field(default_factory=AtlasSection)
    chart: ChartSection | None = None
    survey: SurveySection = field(default_factory=SurveySection)
    random: RandomSection | None = None
    text: str = ""
    conditions: dict[str, float] = field(default_factory=dict)
    tables: tuple[Table, ...] = ()
    all_kinds: Sequence[Kind] | None = None
    kinds_digest: str = ""

    @classmethod
    def of(
        cls,
        path: Path,
        sort: Sort,
        name: str,
        parameters: dict[str, float],
        file: Sections,
        **machine: Any,
    ) -> Study:
        """A study from its sections, and its `model` or `flow` and `loose` parameters."""
        go = file.continue_
        said = {**dict(file), "model": None, **dict(file.start), **dict(go)}
        own: dict[str, Any] = {
            "path": path,
            "sort": sort,
            "name": name,
            "parameters": parameters,
            "within": tuple(go.within),
            "settings": go.model_dump(include=SETTINGS, exclude_none=True),
            "bounds": {measure: (low, high) for measure, (low, high) in go.bounds.items()},
        }
        known = {entry.name: said[entry.name] for entry in fields(cls) if entry.name in said}
        return cls(**known | own | machine)

    @property
    def named_state(self) -> dict[str, float] | None:
        """Where the motion of a machine begins, by name."""
        return self.state if isinstance(self.state, dict) else None

    @property
    def options(self) -> dict[str, Any]:
        """Of each diagram or atlas."""
        return {"depth": self.depth, "virtual": self.virtual, "settings": self.settings}

    def describe(self) -> dict[str, Any]:
        """What decides the result, as JSON scalars and lists."""
        start: dict[str, Any] = {"word": self.word, "periods": self.periods, "guess": self.guess}
        go: dict[str, Any] = {"parameter": self.parameter, "within": list(self.within), **self.options}
        if self.state and self.sort is Sort.PAGE:
            start["state"] = self.state
        if self.bounds:  # as text: JSON has no infinity
            go["bounds"] = {name: [repr(end) for end in ends] for name, ends in self.bounds.items()}
        if self.kinds:
            go["kinds"] = [self.kinds, self.kinds_digest]
        more = {"conditions": self.conditions} if self.conditions else {}
        return {"model": self._model(), "start": start, "continue": go, **more}

    def having(self, section: str, **values: Any) -> Study:
        """The study with other values in a section, one of `sweep`, `atlas`, `survey`."""
        return replace(self, **{section: getattr(self, section).model_copy(update=values)})

    def kept(self, command: str, target: Path) -> dict[str, Any]:
        """What a file keeps of its study: `describe()`, and the text from which `contvines rerun` does the command again.

        Parameters
        ----------
        command : str
        target : Path
            The file; the study's place is kept as seen from there.
        """
        place = os.path.relpath(self.path.absolute(), target.absolute().parent)
        return {**self.describe(), "source": {"command": command, "study": place, "text": self.text}}

    def _model(self) -> dict[str, Any]:
        if self.sort is Sort.PHYSICAL:
            return self.model.settings()
        if self.sort is Sort.FLOW:
            own = {"name": self.name, "digest": self.flow.origin[2], "state": self.state, "box": self.box}
            return {**own, **self.parameters}
        own = self.model.settings() if self.sort is Sort.PAGE else {}
        # the text of a machine file decides, wherever it lies; the name of a machine that comes with the package
        for name in ("page", "source", "digest") if self.name in PAGES else ("page",):
            own.pop(name, None)
        if self.sort is Sort.CATALOGUE and self.model.contact_time is not None:
            own = {"contact_time": self.model.contact_time}
        return {**own, "name": self.name, **self.parameters}

    def fingerprint(self, command: str = "diagram") -> str:
        """Digest of `describe()` and the command: two runs that must give the same graph share it, and those that go on from one another."""
        more = {"atlas": self.atlas.of_results()} if command == "atlas" else {}
        return digest_of({"command": command, **more, **self.describe()})


def without_word(study: Study, refusal: object) -> str:
    """The refusal of a study's first orbit, with the way out where the study names its word."""
    if study.word is None:
        return str(refusal)
    shown = study.word if len(study.word) <= SHOWN else study.word[: SHOWN - 3] + "..."
    return (
        f"{str(refusal).rstrip('.')}; or delete the line word = {json.dumps(shown)} of [start] (periods and guess, too): "
        "the motion that settles from rest is taken then"
    )


def wrong_intervals(
    file: Sections, first: float | None, refusal: Callable[[str, float], str], unit: str = ""
) -> list[str]:
    """What is wrong with the intervals of a study.

    Parameters
    ----------
    file : the sections.
    first : float, optional
        Of the parameter that varies, at the start.
    refusal : callable
        (parameter, value) -> why it cannot have the value, as it follows the interval; empty if it can.
    unit : str
        Of the parameter that varies.
    """
    go, wrong = file.continue_, []
    intervals = [("continue", go.parameter, go.within)]
    if isinstance(file, MachineSections) and file.sweep.within is not None:
        intervals.append(("sweep", go.parameter, file.sweep.within))
    if file.chart is not None:
        intervals.append(("chart", file.chart.parameter, file.chart.within))
    for section, name, (low, high) in intervals:
        why = next(filter(None, (refusal(name, value) for value in (low, high))), "")
        if low >= high:
            why = (
                " is empty; expected low < high."
                if low == high
                else " is reversed; give the lower end first."
            )
        wrong += [f"[{section}] within = {[low, high]!r}{why}"] if why else []
    low, high = go.within
    if first is not None and low < high and not low <= first <= high:
        said = f"{first!r} lies outside [continue] within = [{low!r}, {high!r}]"
        if unit:
            said = f"{first:g} {unit} lies outside [continue] within = [{low:g}, {high:g}] {unit}"
        wrong.append(f"[start] {go.parameter} = {said}; start inside the interval, or widen it.")
    return wrong


class StudyError(ValueError):
    """A study that cannot be run; the message says which value and a way out."""


def validated(model: type[S], data: dict[str, Any], wrong: list[str] | None = None) -> S:
    """A study's sections, checked.

    Parameters
    ----------
    model : type of Section
        Of the whole study; see `contvines.command.schema.study_model`.
    data : dict
    wrong : list of str, optional
        Sentences that are reported, too.

    Raises
    ------
    StudyError
        With all that pydantic refuses, a sentence for each field.
    """
    try:
        return model.model_validate(data)
    except ValidationError as error:
        model_keys = {field.alias or name for name, field in model.model_fields.items()}
        found: dict[Any, str] = {}
        for each in error.errors():
            loc = [part for part in each["loc"] if not (isinstance(part, str) and UNION.fullmatch(part))]
            if (
                len(loc) == 1
                and each["type"] == "missing"
                and did_you_mean(str(loc[0]), data.keys() - model_keys)
            ):
                continue  # the misspelt section is reported
            union = len(loc) < len(each["loc"])  # of a field that may be one of several types, one sentence
            found.setdefault((*loc, "" if union else each["type"]), _sentence(model, loc, each))
        raise together([*(wrong or ()), *found.values()]) from None


def refuse(wrong: list[str]) -> None:
    """Raise `StudyError` with these sentences, if there are any."""
    if wrong:
        raise together(wrong)


def together(sentences: list[str]) -> StudyError:
    """All sentences in one error."""
    unique = list(dict.fromkeys(sentences))
    if len(unique) == 1:
        return StudyError(unique[0])
    more = [f"and {len(unique) - MOST} more"] if len(unique) > MOST else []
    lines = [f"  - {sentence}" for sentence in unique[:MOST] + more]
    return StudyError("\n".join([f"{len(unique)} things to mend:", *lines]))


def _sentence(model: type[Section], loc: list[int | str], error: ErrorDetails) -> str:
    kind, given = error["type"], error["input"]
    section, value = _cut(str(loc[0])), _cut(repr(given))
    sections = {field.alias or name: field for name, field in model.model_fields.items()}
    if len(loc) == 1:
        if kind == "missing":
            return f"the section [{section}] is missing; it holds {SECTIONS[section]}."
        if kind == "extra_forbidden":
            known = ", ".join(f"[{name}]" for name in sections)
            written = f"[{section}]" if isinstance(given, dict) else f"{section} = {value}"
            return (
                f"{written}: there is no such section{did_you_mean(section, sections)}; a study has {known}."
            )
        return (
            f"{section} = {value} is not a section; write [{section}] on a line of its own, its keys below."
        )
    key, fields = _cut(str(loc[1])), _fields(sections[section])
    place = f"[{section}] {key}" + "".join(f"[{i}]" for i in loc[2:])
    said = f"{place} = {value}"
    if kind == "extra_forbidden":
        if section == "model" and key in _fields(sections["start"]):
            return f"{said}: this belongs to [start], beside the word."
        return f"{said}: there is no such field{did_you_mean(key, fields)}; known are {', '.join(fields)}."
    if kind == "literal_error":
        known = re.findall(r"'([^']*)'", str(error.get("ctx", {})["expected"]))
        what = "parameter" if key == "parameter" else "choice"
        return f"{said}: there is no such {what}{did_you_mean(str(given), known)}; choose one of {', '.join(known)}."
    if kind == "missing":
        said = f"{place} is missing"
    elif kind == "string_too_long":
        said = f"{place} has {len(given)} letters"
    elif kind in ("too_short", "too_long"):
        said += f" has {len(given)} entries"
    else:
        said += f" {WRONG.get(kind, 'cannot be used')}"
    return f"{said}; expected {_expected(fields[str(loc[1])])}."


def _fields(section: FieldInfo) -> dict[str, FieldInfo]:
    return {field.alias or name: field for name, field in kind_of(section).model_fields.items()}


def _expected(field: FieldInfo) -> str:
    """The value that a field expects: its description, or that of its type."""
    parts = (part for kind in get_args(field.annotation) for part in getattr(kind, "__metadata__", ()))
    return field.description or next(
        (part.description for part in parts if getattr(part, "description", None)), "another value"
    )


def _cut(text: str) -> str:
    return text if len(text) <= 60 else text[:57] + "..."


@contextmanager
def refused(place: str) -> Iterator[None]:
    """Say of which place, a file, field or option with its value, a refusal is.

    Raises
    ------
    ValueError
    """
    try:
        yield
    except ValueError as error:
        raise ValueError(f"{place}: {str(error).rstrip('.')}.") from error
