"""Settings of a continuation run."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, fields
from typing import Any, ParamSpec, TypeVar

from contvines.shared import near_names
from contvines.shared.near_names import did_you_mean


@dataclass(frozen=True)
class StepRule:
    """A rule for the length of steps along a branch.

    The continuation loop asks it after every step that the corrector has brought back to the branch; a step that the corrector gives up is halved
    without asking.

    Parameters
    ----------
    judge : callable
        ``judge(turn, error, sweeps, length, angle, roundoff) -> factor``. The next step is `factor` times as long as this one if the
        factor is positive; a negative one, above -1, rejects this step, which is tried again ``-factor`` times as long. It gets

        ``turn``
            the angle between the tangents before and after the step, radians;
        ``error``
            the distance of the corrected point from the predicted one;
        ``sweeps``
            how many Newton corrections that took;
        ``length``
            the length of the step, in the metric of the run (`contvines.Settings`);
        ``angle``
            the angle to aim at, from the settings;
        ``roundoff``
            the distance below which errors mean nothing.

    name : str
        What a graph's settings call it.
    """

    judge: Callable[..., float]
    name: str

    def __post_init__(self) -> None:
        if not callable(self.judge):
            raise ValueError(
                f"step_rule: judge = {self.judge!r} must be a function of (turn, error, sweeps, length, angle, roundoff)"
            )
        if not isinstance(self.name, str):
            raise ValueError(f"step_rule: name = {self.name!r} must be a text")

    def factor(self, *numbers: float) -> float:
        """What ``judge`` says of a step.

        Raises
        ------
        ValueError
            If it returns no such factor.
        """
        found = self.judge(*numbers)
        try:
            factor = float(found)
        except (TypeError, ValueError):
            factor = 0.0
        if not (factor > 0.0 or -1.0 < factor < 0.0):
            raise ValueError(
                f"step_rule {self.name!r}: judge returned {found!r} for a step of length {numbers[3]:.3g}; a factor is asked for, "
                "above 0 for the next step, or between -1 and 0 to try this one again"
            )
        return factor


def by_angle(turn, error, sweeps, length, angle, roundoff):  # native/march.hpp has the same
    """Aim at an angle between neighbouring tangents (as COCO does).

    An angle beyond twice of it, or a predictor error beyond the angle times the step, rejects the step.
    """
    if not (turn <= 2.0 * angle and error <= angle * length + roundoff):
        return -0.5
    factor = 2.0
    if turn > 0.5 * angle:
        factor = max(0.5, angle / turn)
    if sweeps > 3:
        factor = min(factor, 0.8)
    return factor


BY_ANGLE = StepRule(by_angle, "angle")


#: settings that may be any positive number; other numbers lie between 0 and 1, whole ones are 1 at least
POSITIVE = ("escape", "mesh_caution")


@near_names.hinted
@dataclass(frozen=True)
class Settings:
    """Settings of the continuation. Lengths are in the metric in which the parameter interval has length 1 and u its rms norm.

    Attributes
    ----------
    tolerance : float
        Steps: largest last Newton correction, relative to 1 + abs(unknown). Newton converges quadratically and a point is
        also asked for a predicted error at roundoff, so points are much more accurate than this.
    angle : float
        Steps: angle between neighbouring tangents to aim at, in radians; beyond twice of it a step is rejected.
    first_step, min_step, max_step : float
        Steps: lengths.
    max_iterations : int
        Steps: Newton sweeps per point.
    max_points : int
        Ends: points per branch and direction.
    first_chunk, chunk : int
        Steps: points that are computed, searched for special points and kept together: at first, and later.
    amplitude : float
        Switching: distance from a special point at which the branch that leaves it is first corrected.
    crooked : float
        Switching: how much of a new branch's deviation from a straight line may be left at half the distance from the special point: a quarter
        on a smooth branch, seven tenths on one that begins like a root and turns round there.
    null : float
        Switching: relative size of a bordered system's smallest singular value below which it is singular; of several null vectors each has
        at least this part of the first one's growth.
    isolated : float
        Switching: the same beside a branch point, where isolated solutions are nearly singular.
    creep : float
        Ends: steps (in the metric) shorter than this, many in a row, lead nowhere.
    escape : float
        Ends: a branch whose unknowns are further than this (rms) from its start has run away.
    max_branches, max_unknowns : int
        Ends: the automatic diagram begins no branch when it has so many, or their points so many unknowns, sixteen bytes each.
    resolution : float
        Special points: length of a segment that is not halved any more. Two branches with a gap narrower than this are not told
        from a branch point; what the ends of so short a segment say and the points found between do not is *unresolved*.
    halvings : int
        Special points: how many times a segment is halved at most whose ends say more than what is found between them.
    parts : int
        Special points: parts of segments that are searched at most along a branch, in each direction; where they are spent, as on a branch that
        folds without end, segments are not halved any more, and those whose ends say more than what is found are *unresolved* as they are.
    upright : float
        Special points: the parameter's part of a unit tangent, in its unit, below which the branch stands upright and has no folds.
    rounding : float
        Special points: changes of the parameter, in its unit, up to which they are rounding.
    aside : float
        Special points: part of a segment, how far on either side of a place signs and tangents are read.
    close : float
        Special points: distance from a border (in the metric) of the point from which one-sided slopes and limits are taken.
    near : float
        Special points: part of a segment below which two places on it are one; distance from a meeting (in the metric) within which tangents
        and multipliers are those of its singular equations.
    shown : float
        Special points: margins above which a virtual branch is certainly real between two points. They are known to half their digits where a
        doubled branch passes the border of the branch that it leaves, as one round gains what the other one loses.
    inside : float
        Special points: margins of a special point above which it lies at no border.
    sliver : float
        Special points: length (in the metric) beside a point at which stability is lost, down to which a stable stretch is looked for.
    exact : float
        Special points: largest residual of a located branch point, in units of the rows; between two branches that pass each other it is larger.
    together : float
        Special points: distance from the circle (the axis) within which multipliers count as crossing at once; double ones are known to half their digits.
    steep : float
        Special points: how much of the first slope the sides of a kink must keep when they are looked at more closely.
    tied : float
        Special points: margins that differ by less vanish together.
    at_end : float
        Special points: distance (in the metric) from the end of a branch below which a bifurcation is that end.
    critical : float
        Special points: distance from the circle (the axis) at which a located multiplier counts as being on it.
    marginal : float
        Special points: multipliers this close to the circle (the axis) do not tell stability.
    located : float
        Special points: error, in the parameter's unit, at which points are known wherever there is one.
    stationary : float
        Special points: the parameter's part of a unit tangent, in its unit, that may be that of a fold.
    one_place : float
        Special points: distance (in the metric) below which two are at one place, and a fold at a border is the border.
    offset : float
        Special points: distance (in the metric) over which slopes are measured that say how errors move a point.
    mesh_caution : float
        Special points: times the difference to a mesh with halved intervals, the stated error of one on a mesh.
    symmetric : float
        Identity: parts that a symmetry changes below this are zero.
    same : float
        Identity: distance of two solutions, relative to 1 + the largest unknown, up to which they are one.
    longest : int
        Surveys: unknowns of a motion met by simulation above which it is not traced: it is one of many in narrow windows, and counts as simulated.
    completion : int
        Surveys: unknowns of all points of the branches that motions met by simulation may add to a diagram (those of an integrated machine, which take
        twenty times as long, count twenty times).
    step_rule : StepRule
        Steps: whether a step is accepted, and how long the next one is; by default the rule that aims at `angle`.
    """

    tolerance: float = 1e-8
    angle: float = 0.1
    first_step: float = 1e-3
    min_step: float = 1e-9
    max_step: float = 0.03
    max_iterations: int = 8
    max_points: int = 20000
    first_chunk: int = 64
    chunk: int = 256
    amplitude: float = 2e-3
    crooked: float = 0.5
    null: float = 1e-5
    isolated: float = 1e-10
    creep: float = 1e-6
    escape: float = 50.0
    max_branches: int = 200
    max_unknowns: int = 50_000_000
    resolution: float = 3e-7
    halvings: int = 16
    parts: int = 5000
    upright: float = 1e-9
    rounding: float = 1e-12
    aside: float = 1e-3
    close: float = 1e-6
    near: float = 1e-4
    shown: float = 1e-6
    inside: float = 1e-10
    sliver: float = 1e-8
    exact: float = 1e-12
    together: float = 1e-3
    steep: float = 0.25
    tied: float = 1e-9
    at_end: float = 1e-8
    critical: float = 1e-4
    marginal: float = 1e-9
    located: float = 1e-9
    stationary: float = 1e-6
    one_place: float = 1e-5
    offset: float = 1e-4
    mesh_caution: float = 2.0
    symmetric: float = 1e-6
    same: float = 1e-6
    longest: int = 200
    completion: int = 400_000
    step_rule: StepRule = BY_ANGLE

    def __post_init__(self) -> None:
        for name, kind in self.__annotations__.items():
            value = getattr(self, name)
            if name in POSITIVE:
                right, wanted = value > 0.0, "a positive number"
            elif kind == "float":
                right, wanted = (
                    isinstance(value, (int, float)) and 0.0 < value < 1.0,
                    "a number between 0 and 1",
                )
            elif kind == "int":
                right, wanted = isinstance(value, int) and value >= 1, "a whole number of at least 1"
            else:
                continue
            if not right:
                raise ValueError(f"settings: {name} = {value!r} must be {wanted}")
        if not isinstance(self.step_rule, StepRule):
            raise ValueError(f"settings: step_rule = {self.step_rule!r} must be a contvines.StepRule")
        if self.min_step >= self.max_step:
            raise ValueError(
                f"settings: min_step = {self.min_step!r} must be smaller than max_step = {self.max_step!r}"
            )

    @classmethod
    def of(cls, values: Settings | Mapping[str, Any] | None) -> Settings:
        """Settings from a dict; unknown names are refused."""
        if isinstance(values, Settings):
            return values
        names = [field.name for field in fields(cls)]
        given: dict[str, Any] = {} if values is None else {**values}  # type: ignore[dict-item]
        for name in given:
            if name not in names:
                raise ValueError(
                    f"settings: there is no {name!r}{did_you_mean(name, names)}; choose from {', '.join(names)}"
                )
        return cls(**given)

    @classmethod
    def kept(cls, values: Mapping[str, Any]) -> Settings:
        """The settings of a run, from what its graph keeps of them: the numbers; a rule of the user's own has to be given again."""
        return cls(
            **{name: values[name] for name in cls.__annotations__.keys() & values if name != "step_rule"}
        )

    def to_dict(self) -> dict[str, Any]:
        """As a JSON-able dict; of a step rule of the user's own the name."""
        values = {name: value for name, value in vars(self).items() if name != "step_rule"}
        return values if self.step_rule is BY_ANGLE else {**values, "step_rule": self.step_rule.name}


@dataclass(frozen=True)
class SolutionSettings:
    """What counts as a solution; no user's business. The native core is handed these numbers, in this order (`Solution` in native/march.hpp).

    Attributes
    ----------
    rounding : float
        Corrections of single points, predictions that miss by so little, and negative margins that are rounding.
    small : float
        Corrections that end Newton's method however they came about, if they are within the tolerance.
    predicted : float
        Predicted error, relative to scale + abs(unknown), at which a point counts as exact.
    stalled : float
        Corrections below this that do not shrink any more are rounding.
    solved : float
        Residual of a solution; part of a number's value at the other end of a segment that is zero.
    huge : float
        Larger corrections are a divergence, and a branch so many times `escape` away has run away in any case.
    left : float
        Part of the last correction that may be left as an error.
    jump : float
        Part of a bracket over which a function that has not come near zero jumps.
    told : float
        Distance of a start from the solution that was found, in typical sizes, that is mentioned.
    cancels : float
        Part of the squares of unknowns below which their difference loses its digits.
    """

    rounding: float = 1e-12
    small: float = 1e-11
    predicted: float = 1e-13
    stalled: float = 1e-6
    solved: float = 1e-9
    huge: float = 1e6
    left: float = 1e-3
    jump: float = 1e-5
    told: float = 1e-2
    cancels: float = 1e-9


SOLUTION = SolutionSettings()

P = ParamSpec("P")
R = TypeVar("R")
T = TypeVar("T")


def hinting(function: Callable[P, R]) -> Callable[P, R]:
    """The function; an argument that it does not have is refused with the names that it has.

    The names of its settings are known, too: they belong into ``settings``.
    """
    return near_names.hinting(function, _setting)


def hinted(thing: type[T]) -> type[T]:
    """The class; its public methods, and what makes it, are `hinting`."""
    return near_names.hinted(thing, _setting)


def _setting(name: str, value: object, known: Sequence[str]) -> str:
    if "settings" not in known or name not in [field.name for field in fields(Settings)]:
        return ""
    return f"it is a setting: use settings={{{name!r}: {value!r}}}"
