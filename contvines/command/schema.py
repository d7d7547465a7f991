"""What a TOML study may hold: its sections, their fields and the range of every parameter."""

from typing import Annotated, Any, Literal

from pydantic import BaseModel, BeforeValidator, ConfigDict, Field

Restitution = Annotated[float, Field(gt=0, le=1)]
LARGEST = (
    1e6  # in the machine's own units, where all numbers are of order one; squares stay far from overflow
)
Positive = Annotated[float, Field(ge=1 / LARGEST, le=LARGEST)]
NonNegative = Annotated[float, Field(ge=0, le=LARGEST)]


def _excitation(value: Any) -> Any:
    """The words of the coupled machine for the two ends of the scale."""
    return {"exact": 1.0, "truncated": 0.0}.get(value, value) if isinstance(value, str) else value


Excitation = Annotated[float, BeforeValidator(_excitation), Field(ge=0, le=1)]


class Section(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True, strict=True, allow_inf_nan=False)


class AbsorberSection(Section):
    """`[model]` of the reduced absorber: a cavity shaken harmonically."""

    name: Literal["absorber"]
    restitution: Restitution
    friction: NonNegative
    gravity: NonNegative
    mass_ratio: NonNegative = 0.0
    frequency: Positive = 1.0


class CoupledSection(Section):
    """`[model]` of the absorber on its oscillator, exact."""

    name: Literal["coupled"]
    restitution: Restitution
    friction: NonNegative
    gravity: NonNegative
    mass_ratio: Positive
    damping: NonNegative = 0.9
    frequency: Positive = 1.0
    forcing: NonNegative | None = None
    excitation: Excitation = 1.0


class StartSection(Section):
    """`[start]`: the first orbit; further keys are parameters and override the model's."""

    model_config = ConfigDict(extra="allow", frozen=True, strict=True, allow_inf_nan=False)

    word: str
    periods: Annotated[int, Field(ge=1, le=4096)] = 1
    guess: list[list[float]] | None = None


class ContinueSection(Section):
    """`[continue]`: the parameter, its interval and how far to go."""

    parameter: str
    within: Annotated[list[float], Field(min_length=2, max_length=2)]
    depth: Annotated[int, Field(ge=0)] = 3
    virtual: bool = False
    tolerance: Annotated[float, Field(gt=0, le=1e-3)] | None = None
    angle: Annotated[float, Field(gt=0, le=0.5)] | None = None
    max_step: Annotated[float, Field(gt=1e-9, le=0.5)] | None = None
    max_points: Annotated[int, Field(ge=1)] | None = None
    max_branches: Annotated[int, Field(ge=1)] | None = None


class SweepSection(Section):
    """`[sweep]`, optional: the brute-force simulation of `contvines sweep`."""

    within: Annotated[list[float], Field(min_length=2, max_length=2)] | None = None
    count: Annotated[int, Field(ge=2, le=1_000_000)] = 400
    transient: Annotated[int, Field(ge=0, le=1_000_000)] = 200
    max_period: Annotated[int, Field(ge=1, le=256)] = 16


class StudyFile(Section):
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
        "excitation": Excitation,
    },
}
EXCITATION = {"absorber": "amplitude", "coupled": "forcing"}
