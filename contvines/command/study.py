"""A TOML study, read and checked before any work starts.

Every value that cannot be used is refused with a sentence that names the field, the value and what would do;
all such sentences of one study are reported together.
"""

import difflib
import hashlib
import json
import tomllib
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import BaseModel, ConfigDict, Field, TypeAdapter, ValidationError

Restitution = Annotated[float, Field(gt=0, le=1)]
Positive = Annotated[float, Field(gt=0)]
NonNegative = Annotated[float, Field(ge=0)]

# What would do, for each field; used in every sentence that refuses a value.
WOULD_DO = {
    "name": "'absorber' or 'coupled'",
    "restitution": "a number in (0, 1], for example 0.76",
    "friction": "a number >= 0, for example 0.5",
    "gravity": "a number >= 0, for example 0.211",
    "mass_ratio": "a number > 0, for example 0.006",
    "frequency": "a number > 0, for example 1.0",
    "amplitude": "a number >= 0, for example 0.55",
    "forcing": "a number >= 0, for example 3.3",
    "damping": "a number >= 0, for example 0.9",
    "excitation": "a number from 0 to 1: 1.0 keeps the damper's share of the base excitation, 0.0 drops it",
    "word": "a word of events such as 'LR', 'LtL' or 'tt', or of maps such as 'LR RL'",
    "periods": "a whole number >= 1",
    "guess": "a list with one [phase, B or w] per event of the word",
    "parameter": "the name of one of the model's parameters",
    "within": "two finite numbers [low, high] with low < high",
    "depth": "a whole number >= 0: how many switches deep",
    "virtual": "true or false",
    "tolerance": "a number in (0, 1e-3], for example 1e-10",
    "angle": "an angle between tangents in (0, 0.5] radians, for example 0.1",
    "max_step": "a number in (1e-9, 0.5], a share of the interval, for example 0.03",
    "max_points": "a whole number >= 1, for example 20000",
    "count": "a whole number >= 2, for example 400",
    "transient": "a whole number of forcing periods >= 0, for example 400",
    "window": "a whole number of forcing periods >= 1, for example 256",
}
SECTIONS = {
    "model": 'name = "absorber" and its parameters',
    "start": 'a word, its periods and a first amplitude, for example word = "LR", periods = 1, amplitude = 0.55',
    "continue": 'what to vary and where, for example parameter = "amplitude", within = [0.2, 1.3]',
}


class StudyError(ValueError):
    """A study that cannot be run; the message says which value and what would do."""


class _Section(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True, strict=True, allow_inf_nan=False)


class AbsorberSection(_Section):
    """`[model]` of the reduced absorber: a cavity shaken harmonically."""

    name: Literal["absorber"]
    restitution: Restitution
    friction: NonNegative
    gravity: NonNegative
    mass_ratio: NonNegative = 0.0
    frequency: Positive = 1.0


class CoupledSection(_Section):
    """`[model]` of the absorber on its oscillator, exact."""

    name: Literal["coupled"]
    restitution: Restitution
    friction: NonNegative
    gravity: NonNegative
    mass_ratio: Positive
    damping: NonNegative = 0.9
    frequency: Positive = 1.0
    forcing: NonNegative | None = None
    excitation: Annotated[float, Field(ge=0, le=1)] = 1.0


class StartSection(_Section):
    """`[start]`: the first orbit; further keys are parameters and override the model's."""

    model_config = ConfigDict(extra="allow", frozen=True, strict=True, allow_inf_nan=False)

    word: str
    periods: Annotated[int, Field(ge=1)]
    guess: list[list[float]] | None = None


class ContinueSection(_Section):
    """`[continue]`: the parameter, its interval and how far to go."""

    parameter: str
    within: Annotated[list[float], Field(min_length=2, max_length=2)]
    depth: Annotated[int, Field(ge=0)] = 3
    virtual: bool = False
    tolerance: Annotated[float, Field(gt=0, le=1e-3)] | None = None
    angle: Annotated[float, Field(gt=0, le=0.5)] | None = None
    max_step: Annotated[float, Field(gt=1e-9, le=0.5)] | None = None
    max_points: Annotated[int, Field(ge=1)] | None = None


class SweepSection(_Section):
    """`[sweep]`, optional: the brute-force simulation of `contvines sweep`."""

    within: Annotated[list[float], Field(min_length=2, max_length=2)] | None = None
    count: Annotated[int, Field(ge=2)] = 400
    transient: Annotated[int, Field(ge=0)] = 400
    window: Annotated[int, Field(ge=1)] = 256


class _File(_Section):
    model: Annotated[AbsorberSection | CoupledSection, Field(discriminator="name")]
    start: StartSection
    continue_: Annotated[ContinueSection, Field(alias="continue")]
    sweep: SweepSection = SweepSection()


# Type of every parameter of every model; the excited amplitude of the reduced model comes from [start].
PARAMETERS: dict[str, dict[str, Any]] = {
    "absorber": {
        "amplitude": NonNegative,
        "restitution": Restitution,
        "friction": NonNegative,
        "gravity": NonNegative,
        "mass_ratio": NonNegative,
        "frequency": Positive,
    },
    "coupled": {
        "forcing": NonNegative,
        "frequency": Positive,
        "damping": NonNegative,
        "mass_ratio": Positive,
        "restitution": Restitution,
        "friction": NonNegative,
        "gravity": NonNegative,
        "excitation": Annotated[float, Field(ge=0, le=1)],
    },
}
EXCITATION = {"absorber": "amplitude", "coupled": "forcing"}


@dataclass(frozen=True)
class Study:
    """A checked study.

    Attributes
    ----------
    path : Path of the TOML file.
    name : "absorber" or "coupled".
    parameters : every parameter of the model at the start, by name.
    word, periods, guess : the first orbit.
    parameter, within, depth, virtual : the continuation.
    settings : the fields of `contvines.continuation.settings.Settings` that the study sets.
    sweep : settings of the brute-force sweep.
    """

    path: Path
    name: str
    parameters: dict[str, float]
    word: str
    periods: int
    guess: list[list[float]] | None
    parameter: str
    within: tuple[float, float]
    depth: int
    virtual: bool
    settings: dict[str, Any]
    sweep: SweepSection

    def describe(self) -> dict[str, Any]:
        """What decides the result, as JSON scalars and lists."""
        return {
            "model": {"name": self.name, **self.parameters},
            "start": {"word": self.word, "periods": self.periods, "guess": self.guess},
            "continue": {
                "parameter": self.parameter,
                "within": list(self.within),
                "depth": self.depth,
                "virtual": self.virtual,
                "settings": self.settings,
            },
        }

    def fingerprint(self, command: str = "diagram") -> str:
        """Digest of `describe()` and the command: two runs that must give the same graph share it."""
        text = json.dumps({"command": command, **self.describe()}, sort_keys=True)
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
        data = tomllib.loads(path.read_text(encoding="utf-8"))
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
    except tomllib.TOMLDecodeError as error:
        raise StudyError(f"{path}: this is not valid TOML: {error}.") from None
    try:
        return check_study(data, path)
    except StudyError as error:
        raise StudyError(f"{path}: {error}") from None


def check_study(data: dict[str, Any], path: str | Path = "study") -> Study:
    """Check a study given as nested dicts; see `read_study`."""
    try:
        file = _File.model_validate(data)
    except ValidationError as error:
        raise StudyError(_together([_sentence(e, data) for e in error.errors()])) from None
    return _resolve(file, Path(path))


def is_database(path: str | Path) -> bool:
    """Whether a file starts like a SQLite database."""
    try:
        with Path(path).open("rb") as file:
            return file.read(16) == b"SQLite format 3\x00"
    except OSError:
        return False


def _resolve(file: _File, path: Path) -> Study:
    """Checks that need more than one field."""
    name = file.model.name
    known = PARAMETERS[name]
    wrong: list[str] = []
    parameters: dict[str, float] = {
        k: v for k, v in file.model.model_dump(exclude={"name"}).items() if v is not None
    }
    for key, value in (file.start.model_extra or {}).items():
        if key not in known:
            wrong.append(_unknown("start", key, value, ["word", "periods", "guess", *known]))
            continue
        refusal = _refusal(known[key], "start", key, value)
        if refusal:
            wrong.append(refusal)
        else:
            parameters[key] = float(value)
    go = file.continue_
    low, high = go.within
    if go.parameter not in known:
        wrong.append(
            f"[continue] parameter = {_show(go.parameter)}: the model {name!r} has no such parameter"
            f"{_did_you_mean(go.parameter, known)}; it has {', '.join(known)}."
        )
    else:
        wrong += _check_interval("continue", go.parameter, go.within, known[go.parameter])
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
        wrong.append(f"[start] {excitation} is missing; {WOULD_DO[excitation]} would do.")
    swept = file.sweep.within
    if swept is not None and go.parameter in known:
        wrong += _check_interval("sweep", go.parameter, swept, known[go.parameter])
    guess = file.start.guess
    if guess is not None:
        width = 2 if name == "absorber" else 4
        for i, node in enumerate(guess):
            if len(node) != width:
                form = "[phase, B or w]" if width == 2 else "[phase, B or w, v, v_rate]"
                wrong.append(
                    f"[start] guess[{i}] = {node!r} has {len(node)} numbers; each event needs {form}."
                )
    if wrong:
        raise StudyError(_together(wrong))
    return Study(
        path=path,
        name=name,
        parameters={k: float(parameters[k]) for k in known if k in parameters},
        word=file.start.word,
        periods=file.start.periods,
        guess=guess,
        parameter=go.parameter,
        within=(float(low), float(high)),
        depth=go.depth,
        virtual=go.virtual,
        settings=go.model_dump(include={"tolerance", "angle", "max_step", "max_points"}, exclude_none=True),
        sweep=file.sweep,
    )


def _check_interval(section: str, parameter: str, within: list[float], kind: Any) -> list[str]:
    low, high = within
    if low == high:
        return [f"[{section}] within = {within!r} is empty; low < high would do."]
    if low > high:
        return [f"[{section}] within = {within!r} is reversed; within = [{high!r}, {low!r}] would do."]
    for value in within:
        if _refusal(kind, section, parameter, value):
            return [
                f"[{section}] within = {within!r} leaves the range of {parameter} at {value!r}; "
                f"{WOULD_DO[parameter]} would do at both ends."
            ]
    return []


def _refusal(kind: Any, section: str, key: str, value: Any) -> str | None:
    """The sentence that refuses a parameter's value, or None if it is fine."""
    try:
        TypeAdapter(kind, config=ConfigDict(strict=True, allow_inf_nan=False)).validate_python(value)
    except ValidationError as error:
        return _sentence({**error.errors()[0], "loc": (section, key), "input": value}, {})
    return None


def _sentence(error: Any, data: dict[str, Any]) -> str:
    """One pydantic error as a sentence: field, value, what would do."""
    kind = error["type"]
    loc = [p for p in error["loc"] if p not in ("absorber", "coupled")]
    section = str(loc[0])
    value = error.get("input")
    if kind in ("union_tag_invalid", "union_tag_not_found"):
        given = value.get("name") if isinstance(value, dict) else None
        if kind == "union_tag_not_found":
            return f"[model] name is missing; {WOULD_DO['name']} would do."
        hint = _did_you_mean(given, PARAMETERS)
        return f"[model] name = {_show(given)}: no such model{hint}; {WOULD_DO['name']} would do."
    if len(loc) == 1:
        if kind == "missing":
            return f"the section [{section}] is missing; it holds {SECTIONS[section]}."
        if kind == "extra_forbidden":
            hint = _did_you_mean(section, [*SECTIONS, "sweep"])
            known = ", ".join(f"[{s}]" for s in [*SECTIONS, "sweep"])
            return f"{section} = {_show(value)}: no such section{hint}; a study has {known}."
        return f"{section} = {_show(value)} is not a section; write [{section}] on a line of its own, its keys below."
    key = str(loc[1])
    place = f"[{section}] {key}" + "".join(f"[{i}]" for i in loc[2:])
    would = WOULD_DO.get(key, "another value")
    if kind == "missing":
        return f"[{section}] {key} is missing; {would} would do."
    if kind == "extra_forbidden":
        return _unknown(section, key, value, _fields(section, data))
    if kind == "finite_number":
        return f"{place} = {_show(value)} is not a finite number; {would} would do."
    if kind in ("greater_than", "greater_than_equal", "less_than", "less_than_equal"):
        return f"{place} = {_show(value)} is out of range; {would} would do."
    if kind in ("too_short", "too_long"):
        return f"{place} = {_show(value)} has {len(value)} entries; {would} would do."
    wanted = {
        "float_type": "a number",
        "int_type": "a whole number",
        "string_type": "text",
        "bool_type": "true or false",
    }
    what = f"is not {wanted[kind]}" if kind in wanted else "cannot be used"
    return f"{place} = {_show(value)} {what}; {would} would do."


def _fields(section: str, data: dict[str, Any]) -> list[str]:
    models: dict[str, type[BaseModel]] = {
        "start": StartSection,
        "continue": ContinueSection,
        "sweep": SweepSection,
    }
    if section == "model":
        name = data.get("model", {}).get("name")
        return list((CoupledSection if name == "coupled" else AbsorberSection).model_fields)
    return list(models[section].model_fields)


def _unknown(section: str, key: str, value: Any, known: list[str]) -> str:
    if section == "model" and key in EXCITATION.values():
        return f"[model] {key} = {_show(value)}: this belongs to [start], beside the word."
    return (
        f"[{section}] {key} = {_show(value)}: there is no such field{_did_you_mean(key, known)}; "
        f"known are {', '.join(known)}."
    )


def _did_you_mean(given: Any, known: Any) -> str:
    close = difflib.get_close_matches(str(given), [str(k) for k in known], n=1, cutoff=0.6)
    return f" (did you mean {close[0]!r}?)" if close else ""


def _show(value: Any) -> str:
    text = repr(value)
    return text if len(text) <= 60 else text[:57] + "..."


def _together(sentences: list[str]) -> str:
    unique = list(dict.fromkeys(sentences))
    if len(unique) == 1:
        return unique[0]
    return f"{len(unique)} things to mend:\n" + "\n".join(f"  - {s}" for s in unique)
