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

    The continuation loop calls it after every step whose point the corrector has solved for; a step for which Newton's method fails is halved
    without calling it.

    Parameters
    ----------
    judge : callable
        ``judge(turn, error, sweeps, length, angle, roundoff) -> factor``. A positive factor accepts the step; the next one is `factor` times as long.
        A negative factor, above -1, rejects the step; it is tried again with ``-factor`` times its length. The arguments are

        ``turn``
            the angle between the tangents before and after the step, radians;
        ``error``
            the distance of the corrected point from the predicted one;
        ``sweeps``
            the number of Newton corrections;
        ``length``
            the length of the step, in the metric of the run (`contvines.Settings`);
        ``angle``
            the angle to aim at, from the settings;
        ``roundoff``
            the distance below which errors are rounding.

    name : str
        Name in the settings of a graph.
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
        """Return the factor of ``judge`` for a step; arguments as for ``judge``.

        Raises
        ------
        ValueError
            If it returns no valid factor.
        """
        found = self.judge(*numbers)
        try:
            factor = float(found)
        except (TypeError, ValueError):
            factor = 0.0
        if not (factor > 0.0 or -1.0 < factor < 0.0):
            raise ValueError(
                f"step_rule {self.name!r}: judge returned {found!r} for a step of length {numbers[3]:.3g}; expected a factor "
                "above 0 for the next step, or between -1 and 0 to try this one again"
            )
        return factor


def by_angle(turn, error, sweeps, length, angle, roundoff):  # native/march.hpp has the same
    """Aim at an angle between neighbouring tangents (as COCO does).

    A step is rejected if the angle exceeds twice this one, or the predictor's error exceeds the angle times the length.
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


#: settings that may be any positive number; other floats lie between 0 and 1, integers are at least 1
POSITIVE = ("escape", "mesh_caution")


@near_names.hinted
@dataclass(frozen=True)
class Settings:
    """Settings of the continuation. Lengths are in the metric: the parameter interval has length 1, and u its rms norm.

    Attributes
    ----------
    tolerance : float
        Steps: largest last Newton correction, relative to 1 + abs(unknown). Newton's method converges quadratically, and the
        predicted error of a point must be rounding, so that points are much more accurate than this.
    angle : float
        Steps: desired angle between neighbouring tangents, in radians; a step with more than twice this angle is rejected.
    first_step, min_step, max_step : float
        Steps: lengths.
    max_iterations : int
        Steps: largest number of Newton corrections per point.
    max_points : int
        Ends: largest number of points per branch and direction.
    first_chunk, chunk : int
        Steps: number of points that are computed, searched for special points and stored together: at first, and later.
    amplitude : float
        Switching: first distance from a special point at which a branch that leaves it is corrected.
    crooked : float
        Switching: largest part of a new branch's deviation from a straight line that may remain at half the distance from the special point.
        It is a quarter on a smooth branch, and 0.7 on one that behaves like a square root and turns round there.
    null : float
        Switching: relative size of the smallest singular value of a bordered system below which it is singular. Each further null vector has
        at least this part of the first one's growth.
    isolated : float
        Switching: the same beside a branch point, where isolated solutions are nearly singular.
    creep : float
        Ends: a branch creeps if many steps in a row are shorter than this.
    escape : float
        Ends: a branch has run away if its unknowns are farther than this (rms) from its start.
    max_branches, max_unknowns : int
        Ends: an automatic diagram starts no further branch once it has this many branches, or its points this many unknowns, of sixteen bytes each.
    resolution : float
        Special points: least length of a segment that is halved. Two branches with a gap narrower than this cannot be distinguished
        from a branch point; a segment of this length whose ends disagree with the points found on it is *unresolved*.
    halvings : int
        Special points: largest number of times that a segment is halved whose ends disagree with the points found on it.
    parts : int
        Special points: largest number of parts of segments that are searched along a branch, in each direction. Once it is reached, as on a branch
        with infinitely many folds, segments are not halved any more; those whose ends disagree with the points found are *unresolved*.
    upright : float
        Special points: the parameter's component of a unit tangent, in its unit, below which the branch is upright and has no folds.
    rounding : float
        Special points: changes of the parameter, in its unit, up to which they are rounding.
    aside : float
        Special points: distance to either side of a position at which signs and tangents are evaluated, as a part of a segment.
    close : float
        Special points: distance from a border at which one-sided slopes and limits are computed.
    near : float
        Special points: two positions on a segment are equal if they differ by less than this part of it. Also the distance from a meeting
        within which tangents and multipliers are unreliable, as the equations are singular there.
    shown : float
        Special points: smallest margin above which a virtual branch is certainly real between two points. Margins have only half their digits where
        a doubled branch passes the border of the branch that it leaves, as one round gains what the other one loses.
    inside : float
        Special points: a special point with a smallest margin above this does not lie at a border.
    sliver : float
        Special points: least length of a stable stretch that is sought beside a point at which stability is lost.
    exact : float
        Special points: largest residual of a located branch point, in units of the rows; between two branches that pass each other it is larger.
    together : float
        Special points: distance from the circle (the axis) within which multipliers count as crossing at once; double ones have only half their digits.
    steep : float
        Special points: part of the first slope that the sides of a kink must keep at every zoom.
    tied : float
        Special points: margins that differ by less than this vanish together.
    at_end : float
        Special points: a bifurcation nearer than this to the end of a branch is that end.
    critical : float
        Special points: distance from the circle (the axis) within which a located multiplier counts as being on it.
    marginal : float
        Special points: distance from the circle (the axis) within which a multiplier does not decide stability.
    located : float
        Special points: accuracy, in the parameter's unit, of all true special points.
    stationary : float
        Special points: the parameter's component of a unit tangent, in its unit, below which a point may be a fold.
    one_place : float
        Special points: distance below which two points are the same, and a fold at a border is the border.
    offset : float
        Special points: distance over which the slopes are measured that convert errors of equations to errors of a special point.
    mesh_caution : float
        Special points: safety factor on the difference to a mesh with halved intervals, from which the error of a point on a mesh is stated.
    symmetric : float
        Identity: the asymmetric part of a solution is zero if it is less than this.
    same : float
        Identity: two solutions are the same if their distance is less than this, relative to 1 + the largest unknown.
    longest : int
        Surveys: largest number of unknowns of a motion found by simulation that is traced; a longer one is one of many in narrow windows, and counts
        as simulated.
    completion : int
        Surveys: largest number of unknowns in all points of branches that are added to a diagram for motions found by simulation (for integrated machines,
        which take twenty times as long, each counts twenty times).
    step_rule : StepRule
        Steps: decides whether a step is accepted, and the length of the next one; by default the rule that aims at `angle`.
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
        """Return settings from a dict; None gives the default.

        Raises
        ------
        ValueError
            If there is no setting of a name, or a value is invalid.
        """
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
        """Return the settings of a run from those stored in its graph; a user-defined step rule is not stored and must be given again."""
        return cls(
            **{name: values[name] for name in cls.__annotations__.keys() & values if name != "step_rule"}
        )

    def to_dict(self) -> dict[str, Any]:
        """Return the settings as a JSON-able dict; of a user-defined step rule only the name."""
        values = {name: value for name, value in vars(self).items() if name != "step_rule"}
        return values if self.step_rule is BY_ANGLE else {**values, "step_rule": self.step_rule.name}


@dataclass(frozen=True)
class SolutionSettings:
    """Fixed tolerances of solutions. The native core receives these numbers, in this order (`Solution` in native/march.hpp).

    Attributes
    ----------
    rounding : float
        Size up to which corrections of single points, errors of predictions, and negative margins are rounding.
    small : float
        A correction below this, and within the tolerance, ends Newton's method in any case.
    predicted : float
        A point is exact if its predicted error, relative to scale + abs(unknown), is below this.
    stalled : float
        Corrections below this that do not shrink any more are rounding.
    solved : float
        Largest residual of a solution. Also: a test function is zero at one end of a segment if it is less than this part of its value at the other end.
    huge : float
        Newton's method diverges with a larger correction; a branch has run away at this many `escape` from its start in any case.
    left : float
        Error of a solution, relative to its last correction.
    jump : float
        A function has a jump if it still changes too much over this part of the first bracket.
    moved : float
        Distance between a given start and the solution found, in typical sizes, from which a message mentions it.
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
    moved: float = 1e-2
    cancels: float = 1e-9


SOLUTION = SolutionSettings()

P = ParamSpec("P")
R = TypeVar("R")
T = TypeVar("T")


def hinting(function: Callable[P, R]) -> Callable[P, R]:
    """Wrap a function so that the error for an unknown argument lists the known ones; for a name of a setting it refers to ``settings``."""
    return near_names.hinting(function, _setting)


def hinted(thing: type[T]) -> type[T]:
    """Apply `hinting` to the public methods and the constructor of a class; return the class."""
    return near_names.hinted(thing, _setting)


def _setting(name: str, value: object, names: Sequence[str]) -> str:
    """Return a hint if the name of an unknown argument is that of a setting; else empty."""
    if "settings" not in names or name not in [field.name for field in fields(Settings)]:
        return ""
    return f"it is a setting: use settings={{{name!r}: {value!r}}}"
