"""Pydantic models of the sections of a TOML study, and models of whole studies made from tables of parameters."""

from collections.abc import Iterable, Mapping
from typing import Annotated, Any, ClassVar, Literal, TypeVar, get_args

from pydantic import (
    AfterValidator,
    BaseModel,
    BeforeValidator,
    ConfigDict,
    Field,
    WithJsonSchema,
    create_model,
)
from pydantic.fields import FieldInfo

from orbits.machines.parameters import CONTACT_TIME, Parameter

LONGEST = 65_536  # largest length of a word: 16 letters for each of the largest number of forcing periods


class Section(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True, strict=True, allow_inf_nan=False)


def text(expected: str, **limits: Any) -> Any:
    """Declare a field: `expected` describes valid values in error messages and editors; `limits` are arguments of pydantic's `Field`."""
    return Field(description=expected, **limits)


def ascending(ends: list[float]) -> list[float]:
    """Check that the first end of an interval is the lower one."""
    if ends[0] < ends[1]:
        return ends
    raise ValueError(
        "is empty; expected low < high" if ends[0] == ends[1] else "is reversed; give the lower end first"
    )


Interval = Annotated[
    list[float],
    text("two finite numbers [low, high] with low < high", min_length=2, max_length=2),
    AfterValidator(ascending),
]
Unbounded = Annotated[float, Field(allow_inf_nan=True)]
Seed = Annotated[int, text("a whole number >= 0", ge=0)]
S = TypeVar("S", bound=Section)
PARAMETER = "the name of one of the model's parameters"


class WordSection(Section):
    """`[start]` of a machine: the first orbit; without a word, the motion on which the machine settles from rest."""

    word: Annotated[
        str | None,
        text("a word of events such as 'LR', 'LtL' or 'tt', or of maps such as 'LR RL'", max_length=LONGEST),
    ] = None
    periods: Annotated[int, text("a whole number from 1 to 4096", ge=1, le=4096)] = 1
    guess: Annotated[
        list[list[float]] | None, text("a list with one [phase, B or w] per event of the word")
    ] = None


class PageStart(WordSection):
    """`[start]` of a declared machine: the first orbit; without a word, the motion on which the machine settles from `state`."""

    state: Annotated[dict[str, float] | None, text("states by name, for example { x = 0.1 }")] = None


class FlowStart(Section):
    """`[start]` of a flow.

    ``state`` is the initial state of a motion that settles on the first cycle; without it, the diagram begins with the equilibrium near the
    flow's own start. ``box`` has the ranges of the starts of an atlas and of basins.
    """

    word: ClassVar[None] = None
    periods: ClassVar[int] = 1
    guess: ClassVar[None] = None
    state: Annotated[list[float] | None, text("one number for each state", min_length=1)] = None
    box: Annotated[list[Interval] | None, text("a pair [low, high] for each state")] = None


class ContinueSection(Section):
    """`[continue]`: the continuation parameter, its interval, the depth, settings, and bounds on measures at which branches end."""

    parameter: Annotated[str, text(PARAMETER)]
    within: Interval
    depth: Annotated[int, text("a whole number >= 0: how many switches deep", ge=0)] = 3
    virtual: Annotated[bool, text("true or false")] = False
    tolerance: Annotated[float | None, text("a number in (0, 1e-3], for example 1e-10", gt=0, le=1e-3)] = None
    angle: Annotated[
        float | None,
        text("an angle between tangents in (0, 0.5] radians, for example 0.1", gt=0, le=0.5),
    ] = None
    max_step: Annotated[
        float | None,
        text("a number in (1e-9, 0.5], a share of the interval, for example 0.03", gt=1e-9, le=0.5),
    ] = None
    max_points: Annotated[int | None, text("a whole number >= 1, for example 20000", ge=1)] = None
    max_branches: Annotated[int | None, text("a whole number >= 1, for example 200", ge=1)] = None
    max_unknowns: Annotated[int | None, text("a whole number >= 1, for example 50000000", ge=1)] = None
    bounds: Annotated[
        dict[str, Annotated[list[Unbounded], Field(min_length=2, max_length=2)]],
        text("two numbers for each measure, for example bounds = { B = [-inf, 3.0] }"),
    ] = {}
    kinds: Annotated[
        str | None, text('a file beside the study and a kind in it, for example "saddles.py:neutral"')
    ] = None


class SweepSection(Section):
    """`[sweep]`, optional: settings of the simulations by `contvines sweep`."""

    within: Interval | None = None
    count: Annotated[int, text("a whole number >= 2 and <= 1000000, for example 400", ge=2, le=1_000_000)] = (
        400
    )
    transient: Annotated[
        int,
        text("a whole number of forcing periods from 0 to 1000000, for example 200", ge=0, le=1_000_000),
    ] = 200
    max_period: Annotated[
        int, text("a whole number of forcing periods from 1 to 256, for example 16", ge=1, le=256)
    ] = 16


class AtlasSection(Section):
    """`[atlas]`, optional: settings of `contvines atlas`; see `contvines.atlas` for their meaning."""

    values: Annotated[
        Annotated[int, Field(ge=1, le=10_000)] | list[float],
        text("a whole number of values from 1 to 10000, for example 16, or a list of values"),
    ] = 16
    starts: Annotated[
        int | None, text("a whole number of starts from 1 to 10000000, for example 256", ge=1, le=10_000_000)
    ] = None
    seed: Seed = 0
    scan: Annotated[
        int | None,
        text("a whole number of further values from 0 to 1000000; 0: none", ge=0, le=1_000_000),
    ] = None
    budget: Annotated[int | None, text("a whole number of 1 or more, for example 500000", ge=1)] = None

    def of_results(self) -> dict[str, Any]:
        """Return the settings that a run and its continuation share, for the study's digest; older files have the old default of starts."""
        return {**self.model_dump(exclude={"budget"}), "starts": self.starts or 256}


class ChartSection(Section):
    """`[chart]`, optional: the second parameter of `contvines chart` and its interval."""

    parameter: Annotated[str, text(PARAMETER)]
    within: Interval


class SurveySection(Section):
    """`[survey]`, optional: the machines and outcomes of `contvines survey`."""

    vary: Annotated[
        dict[str, Any], text('names and their values, for example half_width = ["10 mm", "15 mm"]')
    ] = {}
    outcomes: Annotated[
        list[str], text("a list of names, for example ['peak', 'activation']", min_length=1)
    ] = ["peak"]
    sampling: Annotated[Literal["latin", "sobol", "random"], text("'latin', 'sobol' or 'random'")] = "latin"
    samples: Annotated[
        int, text("a whole number >= 1 and <= 1000000, for example 32", ge=1, le=1_000_000)
    ] = 32
    seed: Seed = 1
    gaps: Annotated[int, text("a whole number of values from 0 to 1000, for example 5", ge=0, le=1000)] = 5
    values: Annotated[int, text("a whole number of values from 0 to 1000, for example 9", ge=0, le=1000)] = 0
    starts: Annotated[int, text("a whole number of starts from 1 to 1000, for example 4", ge=1, le=1000)] = 1
    atlas: Annotated[bool, text("true or false")] = False


class RandomSection(Section):
    """`[random]`, optional: the random excitation of `contvines random`."""

    psd: Annotated[
        list[Annotated[list[float], Field(min_length=2, max_length=2)]],
        text("rows [frequency, density], for example [[2, 0.1], [20, 0.1]]", min_length=2),
    ]
    parameter: Annotated[str | None, text("the name of a parameter of a declared machine")] = None
    periods: Annotated[float, text("a number from 10 to 1e6, for example 2000", ge=10, le=1e6)] = 2000.0
    records: Annotated[int, text("a whole number from 2 to 10000, for example 8", ge=2, le=10_000)] = 8
    seed: Seed = 0


class FlowSections(Section):
    """The sections of a study of a flow, besides `[model]`."""

    start: FlowStart = FlowStart()
    continue_: Annotated[ContinueSection, Field(alias="continue")]
    atlas: AtlasSection = AtlasSection()
    chart: ChartSection | None = None
    survey: SurveySection = SurveySection()


class MachineSections(Section):
    """The sections common to studies of machines, besides `[model]`."""

    continue_: Annotated[ContinueSection, Field(alias="continue")]
    sweep: SweepSection = SweepSection()
    atlas: AtlasSection = AtlasSection()
    chart: ChartSection | None = None
    survey: SurveySection = SurveySection()
    random: RandomSection | None = None


class StudySections(MachineSections):
    """The sections of a study of a built-in machine, besides `[model]`."""

    start: WordSection = WordSection()


class PageSections(MachineSections):
    """The sections of a study of a declared machine, besides `[model]`."""

    start: PageStart = PageStart()


Sections = StudySections | PageSections | FlowSections


class _AnyStart(Section):
    model_config = ConfigDict(extra="allow", frozen=True)


class UnknownModel(MachineSections):
    """The sections of a study whose model is unknown, with all checks that do not need it."""

    model: object = None
    start: _AnyStart = _AnyStart()


def expected_value(entry: Parameter) -> str:
    """Describe the valid values of a parameter, as the end of a sentence."""
    limits = entry.limits.in_studies
    if limits.open:
        return f"a number in ({limits.low:g}, {limits.high:g}], for example {entry.example:g}"
    span = f"a number from {shown(limits.low)} to {shown(limits.high)}"
    if entry.words:
        return f"{', '.join(repr(word) for word in entry.words)}, or {span} ({entry.meaning})"
    return f"{span}, for example {entry.example:g}"


def shown(number: float) -> str:
    """Format a limit: 1e6, not 1e+06."""
    return f"{number:g}".replace("e+0", "e").replace("e-0", "e-")


def number(entry: Parameter) -> Any:
    """Return the type of a parameter's values in a study: a number within its limits, or one of its words."""
    limits = entry.limits.in_studies
    ends = {"gt" if limits.open else "ge": limits.low, "le": limits.high}
    entry_schema = {"description": f"{entry.meaning}; for example {entry.example:g}"}
    kind = Annotated[float, Field(description=expected_value(entry), json_schema_extra=entry_schema, **ends)]  # type: ignore[arg-type]
    if not entry.words:
        return kind

    def coded(value: object) -> object:
        return entry.words.get(value, value) if isinstance(value, str) else value

    span = {"type": "number", "minimum": limits.low, "maximum": limits.high}
    written = {"anyOf": [{"enum": list(entry.words)}, span], **entry_schema}
    return Annotated[kind, BeforeValidator(coded), WithJsonSchema(written)]


def study_model(
    base: type[S], settings: Mapping[str, tuple[Any, Any]], parameters: Mapping[str, Any]
) -> type[S]:
    """Return the pydantic model of a whole study.

    Parameters
    ----------
    base : type of Section
        The sections besides `[model]`.
    settings : mapping
        Type and default (``...`` if none) of each field of `[model]`, by name.
    parameters : mapping
        Type of each parameter, by name: `[start]` may set it, `[continue]` and `[chart]` may vary it.
    """
    chosen = Annotated[Literal[tuple(parameters)], text(PARAMETER)]  # type: ignore[valid-type]
    kinds: dict[str, Any] = {name: kind_of(field) for name, field in base.model_fields.items()}
    own = kinds["start"].model_fields
    start = _section(
        kinds["start"], {k: (kind | None, None) for k, kind in parameters.items() if k not in own}
    )
    section, chart = (_section(kinds[name], {"parameter": (chosen, ...)}) for name in ("continue_", "chart"))
    sections: dict[str, Any] = {
        "model": (_section(Section, settings), ...),
        "start": (start, start()),
        "continue_": (Annotated[section, Field(alias="continue")], ...),
        "chart": (chart | None, None),
    }
    return create_model(base.__name__, __base__=base, **sections)


def _section(base: type[Section], fields: Mapping[str, tuple[Any, Any]]) -> Any:
    """Return the model of a section with further fields, by aliases, as their names may be those of methods of pydantic."""
    own: dict[str, Any] = {
        name if name in base.model_fields else f"field_{place}": (Annotated[kind, Field(alias=name)], default)
        for place, (name, (kind, default)) in enumerate(fields.items())
    }
    return create_model(base.__name__, __base__=base, __doc__=base.__doc__, **own)


def kind_of(field: FieldInfo) -> type[Section]:
    """Return the section model that is the type of a field of a study."""
    kinds: Iterable[Any] = (field.annotation, *get_args(field.annotation))
    return next(kind for kind in kinds if isinstance(kind, type) and issubclass(kind, Section))


def values_of(file: Any, names: Iterable[str]) -> dict[str, Any]:
    """Return the values (or defaults) of some names in a checked study; a value in `[start]` replaces that in `[model]`."""
    values = {}
    for section in (file.model, file.start):
        values |= section.model_dump(by_alias=True, exclude_none=True)
    return {name: values[name] for name in names if name in values}


def catalogue_model(name: str) -> type[StudySections]:
    """Return the model of studies of a machine of the catalogue."""
    from orbits.machines.names import model_class

    machine = model_class(name)
    settings: dict[str, Any] = {"name": (Literal[name], ...)}  # type: ignore[valid-type]
    defaults = machine.defaults()
    for entry in machine.settable:
        if entry.name not in defaults:
            continue
        default, kind = defaults[entry.name], number(entry)
        if default is None:
            settings[entry.name] = (kind | None, None)
        else:
            settings[entry.name] = (kind, default if default is ... else entry.number(default))
    settings[CONTACT_TIME.name] = (number(CONTACT_TIME) | None, None)
    return study_model(StudySections, settings, {entry.name: number(entry) for entry in machine.settable})
