"""A TOML study, read and checked before any work starts.

Every value that cannot be used is refused with a sentence that names the field, the value and what would do;
all such sentences of one study are reported together.
"""

import hashlib
import json
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from pydantic import TypeAdapter, ValidationError

from contvines.command.flow_study import check as check_flow
from contvines.command.flow_study import flow_of
from contvines.command.own_kinds import load_kinds
from contvines.command.page_study import check as check_page
from contvines.command.page_study import is_page
from contvines.command.physical_study import converted, is_physical
from contvines.command.schema import (
    EXCITATION,
    PARAMETERS,
    AtlasSection,
    ChartSection,
    StudyFile,
    StudySections,
    SurveySection,
    SweepSection,
)
from contvines.command.sentences import (
    refusal_of,
    sentences_of,
    together,
    unknown_field,
    would_do,
)
from contvines.command.toml_text import TomlError, toml_data
from contvines.shared.near_names import did_you_mean
from orbits.machines.catalogue import model_class


class StudyError(ValueError):
    """A study that cannot be run; the message says which value and what would do."""


@dataclass(frozen=True)
class Study:
    """A checked study.

    Attributes
    ----------
    path : Path of the TOML file.
    name : of the machine, as in `orbits.machines.catalogue`.
    parameters : every parameter of the model at the start, by name.
    word, periods, guess : the first orbit.
    parameter, within, depth, virtual : the continuation.
    flow, start_state, box : of a study of differential equations: the flow, where a motion begins whose cycle is followed, ranges of many starts.
    bounds : (low, high) of measures at which branches end; infinite where there is none.
    settings : the fields of `contvines.continuation.settings.Settings` that the study sets.
    sweep, atlas : settings of the brute-force sweep and of the atlas.
    chart : second parameter and its interval, of a chart.
    machine : a ready machine, where the study describes one that the catalogue does not have (a page).
    loose : parameters to hand to the ready machine with each orbit.
    state : where the simulation starts that looks for a first orbit, if no word is given.
    quantities : of a study in physical units, the machine's settings; its parameters are then counted in their units.
    survey : the many machines of a survey.
    kinds : file and name of the user's own kinds of special points.
    """

    path: Path
    name: str
    parameters: dict[str, float]
    word: str | None
    periods: int
    guess: list[list[float]] | None
    parameter: str
    within: tuple[float, float]
    depth: int
    virtual: bool
    settings: dict[str, Any]
    sweep: SweepSection
    atlas: AtlasSection = field(default_factory=AtlasSection)
    chart: ChartSection | None = None
    machine: Any = None
    loose: dict[str, float] = field(default_factory=dict)
    state: dict[str, float] | None = None
    quantities: dict[str, Any] | None = None
    survey: SurveySection = field(default_factory=SurveySection)
    bounds: dict[str, tuple[float, float]] = field(default_factory=dict)
    flow: Any = None
    start_state: list[float] | None = None
    kinds: str | None = None
    box: list[list[float]] | None = None

    def describe(self) -> dict[str, Any]:
        """What decides the result, as JSON scalars and lists."""
        return {
            "model": self._model(),
            "start": {
                "word": self.word,
                "periods": self.periods,
                "guess": self.guess,
                **({"state": self.state} if self.state else {}),
            },
            "continue": {
                "parameter": self.parameter,
                "within": list(self.within),
                "depth": self.depth,
                "virtual": self.virtual,
                "settings": self.settings,
                # as text: JSON has no infinity
                **(
                    {"bounds": {k: [repr(end) for end in v] for k, v in self.bounds.items()}}
                    if self.bounds
                    else {}
                ),
                **({"kinds": [self.kinds, load_kinds(self.path, self.kinds)[1]]} if self.kinds else {}),
            },
        }

    def _model(self) -> dict[str, Any]:
        if self.quantities:
            return self.quantities
        if self.flow is not None:
            return {
                "name": self.name,
                "digest": self.flow.origin[2],
                "state": self.start_state,
                "box": self.box,
                **self.parameters,
            }
        own = {} if self.machine is None else self.machine.settings()
        return {**own, "name": self.name, **self.parameters}

    def fingerprint(self, command: str = "diagram") -> str:
        """Digest of `describe()` and the command: two runs that must give the same graph share it."""
        more = {"atlas": self.atlas.model_dump()} if command == "atlas" else {}
        text = json.dumps({"command": command, **more, **self.describe()}, sort_keys=True)
        return hashlib.sha256(text.encode()).hexdigest()


def read_study(path: str | Path) -> Study:
    """Read and check a TOML study.

    Raises
    ------
    StudyError
        If the file cannot be read, is not TOML, or holds a value that cannot be used.
    """
    path = Path(path)
    try:
        data = toml_data(path.read_text(encoding="utf-8"))
    except FileNotFoundError:
        raise StudyError(f"{path}: there is no such file; give the path of a TOML study.") from None
    except IsADirectoryError:
        raise StudyError(f"{path}: this is a folder; give the path of a TOML study.") from None
    except OSError as error:
        raise StudyError(f"{path}: cannot be read ({error.strerror}).") from None
    except UnicodeDecodeError:
        hint = (
            " It is a database: commands that take a study want the .toml file." if is_database(path) else ""
        )
        raise StudyError(f"{path}: this is not a TOML file (it is not text).{hint}") from None
    except TomlError as error:
        raise StudyError(f"{path}: {error}.") from None
    try:
        return check_study(data, path)
    except StudyError as error:
        raise StudyError(f"{path}: {error}") from None


def check_study(data: dict[str, Any], path: str | Path = "study") -> Study:
    """Check a study given as nested dicts; see `read_study`."""
    if is_page(data):
        try:
            flow = flow_of(data, Path(path))
            if flow is not None:
                return Study(**check_flow(data, Path(path), flow))
            return Study(**check_page(data, Path(path)))
        except (ValueError, OSError) as error:
            raise StudyError(str(error)) from None
    if is_physical(data):
        return _physical(data, Path(path))
    try:
        file = StudyFile.model_validate(data)
    except ValidationError as error:
        raise StudyError(together(sentences_of(error, data))) from None
    return _resolve(file, Path(path))


def _physical(data: dict[str, Any], path: Path) -> Study:
    """A study in physical units."""
    machine, plain, wrong = converted(data)
    try:
        file = StudySections.model_validate(plain)
    except ValidationError as error:
        raise StudyError(together([*wrong, *sentences_of(error, data)])) from None
    if machine is None and not wrong:
        wrong = ["the section [model] is missing; it holds the machine's name and its quantities."]
    if machine is None:
        raise StudyError(together(wrong))
    go = file.continue_
    own = machine.quantities
    if go.parameter in own:
        wrong += _check_ends("continue", go.within) or _check_first(go, own[go.parameter], machine)
    wrong += _check_ends("sweep", file.sweep.within) if file.sweep.within else []
    wrong += _check_guess(file.start.guess, machine.name)
    if wrong:
        raise StudyError(together(wrong))
    return _study(path, machine.name, own, file, machine.settings())


def _check_first(go: Any, first: float, machine: Any) -> list[str]:
    low, high = go.within
    if low <= first <= high:
        return []
    unit = machine.units.get(go.parameter, "")
    return [
        f"[start] {go.parameter} = {first:g} {unit}".rstrip()
        + f" lies outside [continue] within = [{low:g}, {high:g}] {unit}".rstrip()
        + "; start inside the interval, or widen it."
    ]


def is_database(path: str | Path) -> bool:
    """Whether a file starts like a SQLite database."""
    try:
        with Path(path).open("rb") as file:
            return file.read(16) == b"SQLite format 3\x00"
    except OSError:
        return False


def _resolve(file: StudyFile, path: Path) -> Study:
    """Checks that need more than one field."""
    name = file.model.name
    known = PARAMETERS[name]
    wrong: list[str] = []
    parameters: dict[str, float] = {
        k: v for k, v in file.model.model_dump(exclude={"name"}).items() if v is not None
    }
    for key, value in (file.start.model_extra or {}).items():
        if key not in known:
            wrong.append(unknown_field("start", key, value, ["word", "periods", "guess", *known]))
            continue
        refusal = refusal_of(name, "start", key, value)
        if refusal:
            wrong.append(refusal)
        else:
            parameters[key] = TypeAdapter(known[key]).validate_python(value)
    go = file.continue_
    low, high = go.within
    if go.parameter not in known:
        wrong.append(
            f"[continue] parameter = {go.parameter!r}: the model {name!r} has no such parameter"
            f"{did_you_mean(go.parameter, known)}; it has {', '.join(known)}."
        )
    else:
        wrong += _check_interval("continue", go.parameter, go.within, name)
        if go.parameter not in parameters and not any(go.parameter in w for w in wrong):
            wrong.append(
                f"[start] {go.parameter} is missing: it is the continuation parameter's first value; "
                f"a number from {low!r} to {high!r} would do."
            )
        first = parameters.get(go.parameter)
        if first is not None and low < high and not low <= first <= high:
            wrong.append(
                f"[start] {go.parameter} = {first!r} lies outside [continue] within = [{low!r}, {high!r}]; "
                f"start inside the interval, or widen it."
            )
    excitation = EXCITATION[name]
    if (
        excitation not in parameters
        and excitation != go.parameter
        and not any(excitation in w for w in wrong)
    ):
        wrong.append(f"[start] {excitation} is missing; {would_do(excitation, name)} would do.")
    swept = file.sweep.within
    if swept is not None and go.parameter in known:
        wrong += _check_interval("sweep", go.parameter, swept, name)
    if file.chart is not None:
        other = file.chart.parameter
        if other not in known:
            wrong.append(
                f"[chart] parameter = {other!r}: the model {name!r} has no such parameter{did_you_mean(other, known)}; "
                f"it has {', '.join(known)}."
            )
        else:
            wrong += _check_interval("chart", other, file.chart.within, name)
    wrong += _check_guess(file.start.guess, name)
    if wrong:
        raise StudyError(together(wrong))
    return _study(path, name, {k: float(parameters[k]) for k in known if k in parameters}, file)


def _check_guess(guess: list[list[float]] | None, name: str) -> list[str]:
    names = model_class(name).node_names
    return [
        f"[start] guess[{i}] = {node!r} has {len(node)} numbers; each event needs [{', '.join(names)}]."
        for i, node in enumerate(guess or ())
        if len(node) != len(names)
    ]


def _study(
    path: Path, name: str, parameters: dict[str, float], file: StudySections, quantities: Any = None
) -> Study:
    go = file.continue_
    return Study(
        path=path,
        name=name,
        parameters=parameters,
        word=file.start.word,
        periods=file.start.periods,
        guess=file.start.guess,
        parameter=go.parameter,
        within=(float(go.within[0]), float(go.within[1])),
        depth=go.depth,
        virtual=go.virtual,
        settings=go.model_dump(
            include={"tolerance", "angle", "max_step", "max_points", "max_branches"}, exclude_none=True
        ),
        sweep=file.sweep,
        atlas=file.atlas,
        chart=file.chart,
        quantities=quantities,
        survey=file.survey,
        bounds={name: (low, high) for name, (low, high) in go.bounds.items()},
        kinds=go.kinds,
    )


def _check_ends(section: str, within: list[float]) -> list[str]:
    low, high = within
    if low == high:
        return [f"[{section}] within = {within!r} is empty; low < high would do."]
    if low > high:
        return [f"[{section}] within = {within!r} is reversed; within = [{high!r}, {low!r}] would do."]
    return []


def _check_interval(section: str, parameter: str, within: list[float], machine: str) -> list[str]:
    ends = _check_ends(section, within)
    if ends:
        return ends
    for value in within:
        if refusal_of(machine, section, parameter, value):
            return [
                f"[{section}] within = {within!r} leaves the range of {parameter} at {value!r}; "
                f"{would_do(parameter, machine)} would do at both ends."
            ]
    return []
