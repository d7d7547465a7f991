"""A checked study, and the checks of what several fields say together."""

import json
import os
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from enum import Enum, auto
from pathlib import Path
from typing import TYPE_CHECKING, Any

from contvines.command.schema import (
    AtlasSection,
    ChartSection,
    MachineSections,
    RandomSection,
    Sections,
    SurveySection,
    SweepSection,
)
from contvines.shared.files import digest_of

if TYPE_CHECKING:
    from contvines.flows.problem import FlowProblem
    from orbits.machines.parameters import Table

SHOWN = 60  # letters of a word that a refusal repeats


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
    kinds : file and name of the user's own kinds of special points.
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
    tables: "tuple[Table, ...]" = ()

    @classmethod
    def of(
        cls,
        path: Path,
        sort: Sort,
        name: str,
        parameters: dict[str, float],
        file: Sections,
        model: object = None,
        flow: "FlowProblem | None" = None,
        loose: dict[str, float] | None = None,
    ) -> "Study":
        """A study from its sections; what is not among them is given."""
        go, start = file.continue_, file.start
        names = ("sweep", "atlas", "chart", "survey", "random")
        first = ("word", "periods", "guess", "state", "box")
        sections = {key: getattr(file, key) for key in names if hasattr(file, key)}
        return cls(
            path=path,
            sort=sort,
            name=name,
            parameters=parameters,
            parameter=go.parameter,
            within=(float(go.within[0]), float(go.within[1])),
            depth=go.depth,
            virtual=go.virtual,
            settings=go.model_dump(
                include={"tolerance", "angle", "max_step", "max_points", "max_branches", "max_unknowns"},
                exclude_none=True,
            ),
            bounds={measure: (low, high) for measure, (low, high) in go.bounds.items()},
            kinds=go.kinds,
            **{key: getattr(start, key) for key in first if hasattr(start, key)},
            **sections,
            model=model,
            flow=flow,
            loose=loose or {},
        )

    @property
    def named_state(self) -> dict[str, float] | None:
        """Where the motion of a machine begins, by name."""
        return self.state if isinstance(self.state, dict) else None

    @property
    def listed_state(self) -> list[float] | None:
        """Where the motion of a flow begins, in the order of its states."""
        return self.state if isinstance(self.state, list) else None

    def describe(self) -> dict[str, Any]:
        """What decides the result, as JSON scalars and lists."""
        start: dict[str, Any] = {"word": self.word, "periods": self.periods, "guess": self.guess}
        go: dict[str, Any] = {
            "parameter": self.parameter,
            "within": list(self.within),
            "depth": self.depth,
            "virtual": self.virtual,
            "settings": self.settings,
        }
        if self.state and self.sort is Sort.PAGE:
            start["state"] = self.state
        if self.bounds:  # as text: JSON has no infinity
            go["bounds"] = {name: [repr(end) for end in ends] for name, ends in self.bounds.items()}
        if self.kinds:
            from contvines.command.own_code import load_kinds

            go["kinds"] = [self.kinds, load_kinds(self.path, self.kinds)[1]]
        more = {"conditions": self.conditions} if self.conditions else {}
        return {"model": self._model(), "start": start, "continue": go, **more}

    def with_budget(self, budget: int) -> "Study":
        """The study with another budget of its atlas."""
        return replace(self, atlas=self.atlas.model_copy(update={"budget": budget}))

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
        own.pop("page", None)  # where the machine file lies; its text decides
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


def wrong_ends(section: str, within: list[float]) -> list[str]:
    """What is wrong with an interval by itself."""
    low, high = within
    if low == high:
        return [f"[{section}] within = {within!r} is empty; expected low < high."]
    if low > high:
        return [f"[{section}] within = {within!r} is reversed; give the lower end first."]
    return []


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
    for section, name, within in intervals:
        refused = next(filter(None, (refusal(name, value) for value in within)), "")
        wrong += wrong_ends(section, within) or (
            [f"[{section}] within = {within!r}{refused}"] if refused else []
        )
    low, high = go.within
    if first is not None and low < high and not low <= first <= high:
        said = f"{first!r} lies outside [continue] within = [{low!r}, {high!r}]"
        if unit:
            said = f"{first:g} {unit} lies outside [continue] within = [{low:g}, {high:g}] {unit}"
        wrong.append(f"[start] {go.parameter} = {said}; start inside the interval, or widen it.")
    return wrong
