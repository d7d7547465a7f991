"""The class of checked studies, checks that involve several fields, and error messages with field, value and remedy."""

from __future__ import annotations

import json
import os
import re
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from enum import Enum, auto
from pathlib import Path
from typing import TYPE_CHECKING, Any, get_args

from pydantic import ValidationError
from pydantic.fields import FieldInfo
from pydantic_core import ErrorDetails

from orbits.machines.names import PAGES
from orbits.words import Word

from ..shared.files import digest_of
from ..shared.near_names import did_you_mean
from .schema import (
    AtlasSection,
    ChartSection,
    ContinueSection,
    FlowStart,
    MachineSections,
    RandomSection,
    S,
    Section,
    Sections,
    SurveySection,
    SweepSection,
    WordSection,
    kind_of,
)

if TYPE_CHECKING:
    from orbits.machines.base import Model
    from orbits.machines.parameters import Table

    from ..bifurcation.kind import Kind


SETTINGS = {"tolerance", "angle", "max_step", "max_points", "max_branches", "max_unknowns"}
SHOWN = 60  # largest number of letters of a value that an error message quotes
UNION = re.compile(r"constrained-\w+|(list|dict)\[.*\]")  # names of types in pydantic's location of an error
MOST = 20  # largest number of errors in one message
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
"""Description of an error, by pydantic's type of error."""


class Sort(Enum):
    """Kinds of studies, by the object that is continued."""

    CATALOGUE = auto()  # a built-in machine in dimensionless numbers
    PHYSICAL = auto()  # a built-in machine in kilograms and hertz
    PAGE = auto()  # a machine that a file beside the study declares
    FLOW = auto()  # differential equations of a file beside the study


@dataclass(frozen=True)
class Study:
    """A checked study.

    Attributes
    ----------
    path : Path
        Of the TOML file.
    sort : Sort
    name : str
        Of the machine or flow, as written in the study.
    parameters : dict
        Values of all parameters at the start.
    start, continue_, sweep, atlas, chart, survey, random
        The checked sections with these names.
    model, flow
        The machine or the flow; the other one is None.
    loose : dict
        Values of the parameters that are given with each orbit, not to the machine's constructor; for declared machines all parameters.
    text : str
        The TOML text.
    conditions : dict
        Values of the conditions.
    tables : tuple of Table
        Parameters as tables over a condition.
    all_kinds, kinds_digest
        The user's and the built-in kinds of special points, and the digest of the user's file, if [continue] names one.
    """

    path: Path
    sort: Sort
    name: str
    parameters: dict[str, float]
    start: WordSection | FlowStart
    continue_: ContinueSection
    sweep: SweepSection = field(default_factory=SweepSection)
    atlas: AtlasSection = field(default_factory=AtlasSection)
    chart: ChartSection | None = None
    survey: SurveySection = field(default_factory=SurveySection)
    random: RandomSection | None = None
    model: Any = None
    flow: Any = None
    loose: dict[str, float] = field(default_factory=dict)
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
        """Make a study from its checked sections; further arguments are the attributes of the machine or flow."""
        return cls(path, sort, name, parameters, **{**dict(file), "model": None, **machine})

    @property
    def parameter(self) -> str:
        """The continuation parameter."""
        return self.continue_.parameter

    @property
    def within(self) -> tuple[float, float]:
        """Its interval."""
        low, high = self.continue_.within
        return low, high

    @property
    def state(self) -> Any:
        """The initial state from which a simulation leads to the first orbit: by name, or for a flow in the order of its states; None if there is none."""
        return getattr(self.start, "state", None)

    @property
    def bounds(self) -> dict[str, tuple[float, float]]:
        """(low, high) by measure, at which branches end; may be infinite."""
        return {measure: (low, high) for measure, (low, high) in self.continue_.bounds.items()}

    @property
    def settings(self) -> dict[str, Any]:
        """Fields of `contvines.continuation.settings.Settings` that the study sets."""
        return self.continue_.model_dump(include=SETTINGS, exclude_none=True)

    @property
    def options(self) -> dict[str, Any]:
        """Arguments of `contvines.diagram` and `contvines.atlas` that the study sets."""
        return {
            "depth": self.continue_.depth,
            "virtual": self.continue_.virtual,
            "settings": self.settings,
        }

    def describe(self) -> dict[str, Any]:
        """Return everything that determines the result, JSON-able."""
        start: dict[str, Any] = {name: getattr(self.start, name) for name in ("word", "periods", "guess")}
        section: dict[str, Any] = {"parameter": self.parameter, "within": list(self.within), **self.options}
        if self.state and self.sort is Sort.PAGE:
            start["state"] = self.state
        if self.bounds:  # as text: JSON has no infinity
            section["bounds"] = {name: [repr(end) for end in ends] for name, ends in self.bounds.items()}
        if self.continue_.kinds:
            section["kinds"] = [self.continue_.kinds, self.kinds_digest]
        more = {"conditions": self.conditions} if self.conditions else {}
        return {"model": self._model(), "start": start, "continue": section, **more}

    def having(self, section: str, **values: Any) -> Study:
        """Return the study with other values in a section (`sweep`, `atlas` or `survey`)."""
        return replace(self, **{section: getattr(self, section).model_copy(update=values)})

    def kept(self, command: str, target: Path) -> dict[str, Any]:
        """Return the data about the study that a result's file stores: `describe()`, and the text with which `contvines rerun` repeats a command.

        Parameters
        ----------
        command : str
        target : Path
            The result's file; the study's path is stored relative to it.
        """
        place = os.path.relpath(self.path.absolute(), target.absolute().parent)
        return {**self.describe(), "source": {"command": command, "study": place, "text": self.text}}

    def _model(self) -> dict[str, Any]:
        if self.sort is Sort.FLOW:
            own = {
                "name": self.name,
                "digest": self.flow.origin[2],
                **self.start.model_dump(include={"state", "box"}),
            }
            return {**own, **self.parameters}
        # files of versions without a younger parameter belong to the study in which it is zero
        unsaid = {name for name in self.model.younger if not self.parameters[name]}
        if self.sort is Sort.PHYSICAL:
            return {key: value for key, value in self.model.settings().items() if key not in unsaid}
        own = self.model.settings() if self.sort is Sort.PAGE else {}
        # a machine file is identified by its text, not its path; a machine of the package by its name
        for name in ("page", "source", "digest") if self.name in PAGES else ("page",):
            own.pop(name, None)
        if self.sort is Sort.CATALOGUE and self.model.contact_time is not None:
            own = {"contact_time": self.model.contact_time}
        given = {key: value for key, value in self.parameters.items() if key not in unsaid}
        return {**own, "name": self.name, **given}

    def fingerprint(self, command: str = "diagram") -> str:
        """Return the digest of `describe()` and the command; equal for runs with equal results, and for a run and its continuation."""
        more = {"atlas": self.atlas.of_results()} if command == "atlas" else {}
        return digest_of({"command": command, **more, **self.describe()})


def without_word(study: Study, refusal: object) -> str:
    """Return the error message for a study's first orbit, with a remedy if the study gives its word."""
    word = study.start.word
    if word is None:
        return str(refusal)
    text = word if len(word) <= SHOWN else word[: SHOWN - 3] + "..."
    return (
        f"{str(refusal).rstrip('.')}; or delete the line word = {json.dumps(text)} of [start] (periods and guess, too): "
        "the motion that settles from rest is taken then"
    )


def wrong_guess(guess: list[list[float]] | None, machine: Model | type[Model]) -> list[str]:
    """Return errors about the nodes of a guess with a wrong count of numbers."""
    names = machine.node_names
    return [
        f"[start] guess[{i}] = {node!r} has {len(node)} numbers; each event needs [{', '.join(names)}]."
        for i, node in enumerate(guess or ())
        if len(node) != len(names)
    ]


def built(study: Study) -> Study:
    """Return the study after checking that its machine can be made and its word is possible.

    Raises
    ------
    StudyError
        If not.
    """
    try:
        vector = study.model.vector(study.loose)
    except ValueError as error:
        raise StudyError(f"[model] {error}") from error
    try:
        Word.parse(study.start.word or "", frictionless=study.model.frictionless(vector))
    except ValueError as error:
        raise StudyError(f"[start] {without_word(study, error)}") from error
    return study


def wrong_intervals(
    file: Sections, first: float | None, refusal: Callable[[str, float], str], unit: str = ""
) -> list[str]:
    """Return the errors of the intervals of a study.

    Parameters
    ----------
    file : Sections
        The checked sections.
    first : float, optional
        Value of the continuation parameter at the start.
    refusal : callable
        ``refusal(parameter, value)`` returns why the parameter cannot have the value; empty if it can.
    unit : str
        Of the continuation parameter.
    """
    continued, wrong = file.continue_, []
    intervals = [("continue", continued.parameter, continued.within)]
    if isinstance(file, MachineSections) and file.sweep.within is not None:
        intervals.append(("sweep", continued.parameter, file.sweep.within))
    if file.chart is not None:
        intervals.append(("chart", file.chart.parameter, file.chart.within))
    for section, name, (low, high) in intervals:
        reason = next(filter(None, (refusal(name, value) for value in (low, high))), "")
        wrong += [f"[{section}] within = {[low, high]!r}{reason}"] if reason else []
    low, high = continued.within
    if first is not None and not low <= first <= high:
        text = f"{first!r} lies outside [continue] within = [{low!r}, {high!r}]"
        if unit:
            text = f"{first:g} {unit} lies outside [continue] within = [{low:g}, {high:g}] {unit}"
        wrong.append(f"[start] {continued.parameter} = {text}; start inside the interval, or widen it.")
    return wrong


class StudyError(ValueError):
    """An invalid study; the message names the value and suggests a remedy."""


def validated(model: type[S], data: dict[str, Any], wrong: list[str] | None = None) -> S:
    """Check the sections of a study by its pydantic model.

    Parameters
    ----------
    model : type of Section
        Of the whole study; see `contvines.command.schema.study_model`.
    data : dict
        The study.
    wrong : list of str, optional
        Errors found before, to be reported together.

    Raises
    ------
    StudyError
        With all errors, a sentence for each field.
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
                continue  # the misspelt section is reported instead
            union = len(loc) < len(each["loc"])  # of a field that may be one of several types, one sentence
            found.setdefault((*loc, "" if union else each["type"]), _sentence(model, loc, each))
        raise together([*(wrong or ()), *found.values()]) from None


def refuse(wrong: list[str]) -> None:
    """Raise a `StudyError` with these sentences, if there are any."""
    if wrong:
        raise together(wrong)


def together(sentences: list[str]) -> StudyError:
    """Return one error with all sentences, or the first `MOST`."""
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
            known = ("model", *sections, "conditions")
            names = ", ".join(f"[{name}]" for name in known)
            written = f"[{section}]" if isinstance(given, dict) else f"{section} = {value}"
            return f"{written}: there is no such section{did_you_mean(section, known)}; a study has {names}."
        return (
            f"{section} = {value} is not a section; write [{section}] on a line of its own, its keys below."
        )
    key, fields = _cut(str(loc[1])), _fields(sections[section])
    place = f"[{section}] {key}" + "".join(f"[{i}]" for i in loc[2:])
    head = f"{place} = {value}"
    if kind == "extra_forbidden":
        if section == "model" and key in _fields(sections["start"]):
            return f"{head}: this belongs to [start], beside the word."
        return f"{head}: there is no such field{did_you_mean(key, fields)}; known are {', '.join(fields)}."
    if kind == "literal_error":
        names = re.findall(r"'([^']*)'", str(error.get("ctx", {})["expected"]))
        noun = "parameter" if key == "parameter" else "choice"
        return f"{head}: there is no such {noun}{did_you_mean(str(given), names)}; choose one of {', '.join(names)}."
    if kind == "value_error":
        return f"{head} {error.get('ctx', {})['error']}."
    if kind == "missing":
        head = f"{place} is missing"
    elif kind == "string_too_long":
        head = f"{place} has {len(given)} letters"
    elif kind in ("too_short", "too_long"):
        head += f" has {len(given)} entries"
    else:
        head += f" {WRONG.get(kind, 'cannot be used')}"
    return f"{head}; expected {_expected(fields[str(loc[1])])}."


def _fields(section: FieldInfo) -> dict[str, FieldInfo]:
    return {field.alias or name: field for name, field in kind_of(section).model_fields.items()}


def _expected(field: FieldInfo) -> str:
    """Describe the valid values of a field, by its description or its type."""
    parts = (part for kind in get_args(field.annotation) for part in getattr(kind, "__metadata__", ()))
    return field.description or next(
        (part.description for part in parts if getattr(part, "description", None)), "another value"
    )


def _cut(text: str) -> str:
    return text if len(text) <= 60 else text[:57] + "..."


@contextmanager
def refused(place: str) -> Iterator[None]:
    """Put a place (a file, or a field or option with its value) before the message of a ValueError raised inside the context.

    Raises
    ------
    ValueError
    """
    try:
        yield
    except ValueError as error:
        raise ValueError(f"{place}: {str(error).rstrip('.')}.") from error
