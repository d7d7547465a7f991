"""What a TOML study may hold: its sections, their fields and the range of every parameter."""

from typing import Annotated, Any, Literal, Union

from pydantic import BaseModel, BeforeValidator, ConfigDict, Field, create_model, model_serializer

from orbits.machines.catalogue import NAMES, model_class
from orbits.machines.parameters import Parameter


def kind(entry: Parameter) -> Any:
    """The type of a parameter's values in a study: a number within its limits, or one of its words."""
    limits = entry.limits.in_studies
    low = {"gt": limits.low} if limits.open else {"ge": limits.low}
    number = Annotated[float, Field(**low, le=limits.high)]  # type: ignore[arg-type]
    if not entry.words:
        return number

    def coded(value: Any) -> Any:
        return entry.words.get(value, value) if isinstance(value, str) else value

    return Annotated[float, BeforeValidator(coded), Field(**low, le=limits.high)]  # type: ignore[arg-type]


def would_do(entry: Parameter) -> str:
    """What a parameter may be, as a sentence ends with it."""
    limits = entry.limits.in_studies
    if limits.open:
        return f"a number in ({limits.low:g}, {limits.high:g}], for example {entry.example:g}"
    span = f"a number from {shown(limits.low)} to {shown(limits.high)}"
    if entry.words:
        return f"{', '.join(repr(word) for word in entry.words)}, or {span} ({entry.meaning})"
    return f"{span}, for example {entry.example:g}"


def shown(number: float) -> str:
    """A limit as people write it: 1e6, not 1e+06."""
    return f"{number:g}".replace("e+0", "e").replace("e-0", "e-")


class Section(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True, strict=True, allow_inf_nan=False)


def _section(name: str) -> type[Section]:
    """`[model]` of one machine: its fields, with the machine's own defaults."""
    machine = model_class(name)
    fields: dict[str, Any] = {"name": (Literal[name], ...)}  # type: ignore[valid-type]
    defaults = machine.defaults()
    for entry in machine.settable:
        if entry.name in defaults:
            default = defaults[entry.name]
            optional = default is None
            wanted = kind(entry) | None if optional else kind(entry)
            fields[entry.name] = (wanted, default if optional or default is ... else entry.number(default))
    return create_model(f"{machine.__name__}Section", __base__=Section, **fields)


MODEL_SECTIONS: dict[str, type[Section]] = {name: _section(name) for name in NAMES}
ModelSection: Any = Annotated[Union[tuple(MODEL_SECTIONS.values())], Field(discriminator="name")]  # noqa: UP007


LONGEST = 65_536  # letters of a word: 16 for each of the most forcing periods


class StartSection(Section):
    """`[start]`: the first orbit (without a word the motion that settles from rest); further keys override the model's parameters."""

    model_config = ConfigDict(extra="allow", frozen=True, strict=True, allow_inf_nan=False)

    word: Annotated[str, Field(max_length=LONGEST)] | None = None
    periods: Annotated[int, Field(ge=1, le=4096)] = 1
    guess: list[list[float]] | None = None


Unbounded = Annotated[float, Field(allow_inf_nan=True)]


class ContinueSection(Section):
    """`[continue]`: the parameter, its interval and how far to go; measures within whose bounds branches stay."""

    parameter: str
    within: Annotated[list[float], Field(min_length=2, max_length=2)]
    depth: Annotated[int, Field(ge=0)] = 3
    virtual: bool = False
    tolerance: Annotated[float, Field(gt=0, le=1e-3)] | None = None
    angle: Annotated[float, Field(gt=0, le=0.5)] | None = None
    max_step: Annotated[float, Field(gt=1e-9, le=0.5)] | None = None
    max_points: Annotated[int, Field(ge=1)] | None = None
    max_branches: Annotated[int, Field(ge=1)] | None = None
    bounds: dict[str, Annotated[list[Unbounded], Field(min_length=2, max_length=2)]] = {}
    kinds: str | None = None


class SweepSection(Section):
    """`[sweep]`, optional: the brute-force simulation of `contvines sweep`."""

    within: Annotated[list[float], Field(min_length=2, max_length=2)] | None = None
    count: Annotated[int, Field(ge=2, le=1_000_000)] = 400
    transient: Annotated[int, Field(ge=0, le=1_000_000)] = 200
    max_period: Annotated[int, Field(ge=1, le=256)] = 16


class AtlasSection(Section):
    """`[atlas]`, optional: where `contvines atlas` simulates, from how many starts, drawn with which seed, how many
    further values in a row must meet nothing new, and how much work it may take."""

    values: Annotated[int, Field(ge=1, le=10_000)] | list[float] = 16
    starts: Annotated[int, Field(ge=1, le=10_000_000)] = 256
    seed: Annotated[int, Field(ge=0)] = 0
    scan: Annotated[int, Field(ge=0, le=1_000_000)] | None = None
    budget: Annotated[int, Field(ge=1)] | None = None

    @model_serializer(mode="wrap")
    def _settings(self, write: Any) -> dict[str, Any]:
        """Without a budget that was not given: files of studies that knew none are theirs still."""
        return {name: value for name, value in write(self).items() if (name, value) != ("budget", None)}


class ChartSection(Section):
    """`[chart]`, optional: the second parameter of `contvines chart`."""

    parameter: str
    within: Annotated[list[float], Field(min_length=2, max_length=2)]


class SurveySection(Section):
    """`[survey]`, optional: the many machines of `contvines survey`."""

    vary: dict[str, Any] = {}
    outcomes: Annotated[list[str], Field(min_length=1)] = ["peak"]
    sampling: Literal["latin", "sobol", "random"] = "latin"
    samples: Annotated[int, Field(ge=1, le=1_000_000)] = 32
    seed: Annotated[int, Field(ge=0)] = 1
    gaps: Annotated[int, Field(ge=0, le=1000)] = 5
    values: Annotated[int, Field(ge=0, le=1000)] = 0
    starts: Annotated[int, Field(ge=1, le=1000)] = 1
    atlas: bool = False


class StudySections(Section):
    """What every study has beside its machine."""

    start: StartSection
    continue_: Annotated[ContinueSection, Field(alias="continue")]
    sweep: SweepSection = SweepSection()
    atlas: AtlasSection = AtlasSection()
    chart: ChartSection | None = None
    survey: SurveySection = SurveySection()


class StudyFile(StudySections):
    model: ModelSection  # type: ignore[valid-type]


PARAMETERS: dict[str, dict[str, Any]] = {
    name: {entry.name: kind(entry) for entry in model_class(name).settable} for name in NAMES
}
"""Type of every parameter of every machine; those that are given with each orbit come from [start]."""
EXCITATION: dict[str, str] = {name: model_class(name).driven_by for name in NAMES}
