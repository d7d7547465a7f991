"""The built-in kinds of special points. Labels, markers in pictures, tables, legends, detection and switching follow from them.

The test functions of folds and of multipliers that cross the unit circle (eigenvalues: the imaginary axis) are here, too. A test function of the
latter is the k-th largest multiplier of a sort, so that two multipliers that cross at once give two special points.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from functools import partial

import numpy as np

from ..continuation.engine import Engine, Solved
from ..continuation.layout import NO_COLUMNS, SLOPE, Aim
from ..continuation.settings import Settings
from ..problems.abilities import Adaptive, Critical
from .branch_point import BRANCH_POINT
from .consistency import no_other_branch
from .kind import JUMP, Classified, Kind, Point, PointOnBranch, Test, passing
from .locate import Segment
from .location_error import rounding_of_parameter
from .normal_forms.criticality import fold_coefficient, near_resonance, pair_form

TURN = Aim(SLOPE, NO_COLUMNS)


def fold_tests(segment: Segment) -> list[Test]:
    """Return the test for folds: the parameter's component of the tangent, if it changes its sign on the segment.

    On an upright branch this component is rounding. For cycles on a mesh the multiplier that crosses +1 is then the test, as at the folds of canards.
    """
    one, other = float(segment.a.tangent[-1]), float(segment.b.tangent[-1])
    if segment.engine.adaptive and _upright(segment):
        passed = passing(segment, "plus")
        return passed if len(passed) == 1 else []
    upright = not segment.turns and max(abs(one), abs(other)) <= segment.engine.upright(segment.a.p)
    return [] if upright or (one >= 0.0) == (other >= 0.0) else [Test(TURN)]


def _upright(segment: Segment) -> bool:
    """Whether the parameter's component of the tangent is only rounding at an end of a segment."""
    return min(abs(end.tangent[-1]) for end in (segment.a, segment.b)) <= segment.engine.upright(segment.a.p)


def turns_back(point: Point) -> bool:
    """Whether a located zero is a fold: the parameter turns back by more than rounding and the noise of the equations.

    On an upright segment of cycles on a mesh: whether the parameter is stationary and no other branch passes.
    """
    assert isinstance(point, PointOnBranch) and point.segment is not None
    segment, engine = point.segment, point.engine
    if engine.adaptive and _upright(segment):
        return no_other_branch(engine, point.solved)
    if segment.turns:
        return True
    reach = max(abs(segment.a.p - point.value), abs(segment.b.p - point.value))
    blur = rounding_of_parameter(engine, point.solved) if engine.adaptive else 0.0
    return reach > max(engine.settled(point.value), blur)


def fold_form(point: PointOnBranch) -> Classified:
    """Return the coefficient a of p = p0 + a s^2, s the amplitude along the critical vector."""
    return Classified(None, fold_coefficient(point.engine, point.solved))


FOLD = Kind(
    "fold",
    "LP",
    text="fold",
    marker="s",
    tests=fold_tests,
    verify=turns_back,
    classify=fold_form,
    locus="fold",
    nothing="the branch turns at a fold; no other branch leaves it",
)


def flips(segment: Segment, kind: str) -> list[Test]:
    """Return the tests for multipliers that cross -1, if this means the given kind for the problem (its `flip_kind`).

    If a complex pair meets on the negative real axis, or two real multipliers leave it as a pair, ranks are not continuous. For cycles on meshes the
    product of all distances from -1 then is the test; it is continuous, as no multiplier passes through infinity.
    """
    engine = segment.engine
    if engine.problem.flip_kind != kind:
        return []
    negative = [
        int(((spectrum.imag == 0.0) & (spectrum.real < 0.0)).sum())
        for spectrum in (engine.spectrum(segment.a.row), engine.spectrum(segment.b.row))
    ]
    if not engine.adaptive or negative[0] == negative[1]:
        return passing(segment, "minus")
    change = segment.counts[1][1] - segment.counts[0][1]
    return [Test(partial(_from_minus_one, engine), 1, JUMP)] if change % 2 else []


def _from_minus_one(engine: Engine, point: Solved) -> float:
    """Return the product of (1 + multiplier) / (1 + |multiplier|); its sign is that of det(M + 1)."""
    spectrum = engine.spectrum(point.row)
    return float(np.real(np.prod((1.0 + spectrum) / (1.0 + np.abs(spectrum)))))


def is_at_minus_one(point: Point) -> bool:
    """Whether the multiplier nearest to -1 really is -1 at a located zero.

    If its distance from -1 is not small, and another multiplier is nearer to it than that, the two have met beside the circle and left the real axis.
    """
    assert isinstance(point, PointOnBranch)
    spectrum = point.engine.spectrum(point.solved.row)
    gaps = np.nan_to_num(np.abs(spectrum + 1.0), nan=np.inf)
    nearest = int(np.argmin(gaps))
    others = np.abs(np.delete(spectrum, nearest) - spectrum[nearest])
    return bool(gaps[nearest] <= max(point.engine.settings.critical, np.nanmin(others, initial=np.inf)))


def pairs(segment: Segment, spectrum: str) -> list[Test]:
    """Return the tests for complex pairs that cross the circle (the imaginary axis), for problems with this kind of spectrum."""
    return passing(segment, "pair") if segment.engine.detection == spectrum else []


def classify_pair(point: PointOnBranch) -> Classified:
    """Return the first Lyapunov coefficient, from derivatives of the equations; for cycles on a mesh from the problem's `normal_form`."""
    problem = point.problem
    if problem.spectrum not in ("map", "flow"):
        return Classified()
    if not (isinstance(problem, Adaptive) and problem.spectrum == "map"):
        return pair_form(problem, point.u, point.value, point.engine.spectrum(point.solved.row))
    upper = point.multipliers[np.imag(point.multipliers) > 0.0]
    if not len(upper):
        return Classified()
    multiplier = complex(upper[np.argmin(np.abs(np.abs(upper) - 1.0))])
    form, remarks = (
        problem.normal_form("neimark-sacker", point.u, point.value, multiplier),
        near_resonance(multiplier),
    )
    if form is None:
        return Classified(remarks=remarks)
    return Classified("supercritical" if form[0] < 0.0 else "subcritical", form[0], remarks)


#: kinds whose tests are multipliers, in the order of the search
PASSING = (
    Kind(
        "symmetry-breaking",
        "SB",
        text="symmetry breaking",
        marker="D",
        filled=False,
        tests=partial(flips, kind="symmetry-breaking"),
        verify=is_at_minus_one,
        locus="flip",
        leaves="doubled",
        without="a pair of solutions of less symmetry leaves here; this problem has no equations for it",
    ),
    Kind(
        "period-doubling",
        "PD",
        text="period doubling",
        marker="^",
        filled=False,
        tests=partial(flips, kind="period-doubling"),
        verify=is_at_minus_one,
        locus="flip",
        leaves="doubled",
        without="a solution of twice the period leaves here; this problem has no equations for it",
    ),
    Kind(
        "neimark-sacker",
        "NS",
        text="Neimark-Sacker",
        marker="p",
        filled=False,
        tests=partial(pairs, spectrum="map"),
        classify=classify_pair,
        locus="pair",
        leaves="circle",
        nothing="an invariant circle leaves a Neimark-Sacker point, not a branch of cycles; the point's circles() computes it",
    ),
    Kind(
        "hopf",
        "HB",
        text="Hopf",
        marker="h",
        filled=False,
        tests=partial(pairs, spectrum="flow"),
        classify=classify_pair,
        locus="pair",
        leaves="cycles",
        nothing="a branch of limit cycles leaves a Hopf point; this problem has equations for equilibria only",
    ),
)


def _border(name: str, label: str, marker: str, text: str = "", filled: bool = True) -> Kind:
    return Kind(name, label, text=text, marker=marker, filled=filled, border=True, leaves="beyond")


#: kinds of borders; where several borders are met at once, the first of them in this order gives the name
_BORDERS = (
    # at a turn friction becomes able to hold the body, or no longer is
    _border("stick", "ST", "<", "turn to stick"),
    # the sliding velocity touches zero within a flight
    _border("velocity-graze", "VG", "v"),
    # a wall is touched with zero velocity
    _border("wall-graze", "WG", ">"),
    # the speed of an impact, or the duration of a stick or flight, becomes zero
    _border("vanishing-event", "VE", "X"),
    # the surface of a switch is touched with zero velocity
    _border("switch-graze", "SG", "d"),
    # events of two contacts happen at once
    _border("corner", "CO", "P", "two events at once"),
    # a solution reaches the surface between two pieces of piecewise-smooth equations
    _border("switch", "SW", "d", filled=False),
    # the period of a cycle grows without bound
    _border("homoclinic", "HC", "H", "homoclinic orbit"),
    # a motion touches the surface of a terminal event
    _border("event", "EV", "8"),
)


USER = Kind("user", "US", text="user function", nothing="nothing leaves the zero of a user function")
"""Zero of a user function; see :mod:`contvines.bifurcation.kind`."""
END = Kind(
    "end",
    "EP",
    text="end of the interval",
    marker="|",
    filled=False,
    nothing="the interval ends here; no branch leaves",
)
KINDS: tuple[Kind, ...] = (
    FOLD,
    *PASSING,
    BRANCH_POINT,
    *_BORDERS,
    USER,
    END,
)
"""The built-in kinds along a branch, in the order of the search."""

MULTIPLIERS = (FOLD, *PASSING, BRANCH_POINT)
# points of codimension two, found along a locus: name, label, text
_ROWS = (
    ("cusp", "CP", "cusp"),
    ("generalized-period-doubling", "GPD", "generalized period doubling"),
    ("degenerate-symmetry-breaking", "GSB", "degenerate symmetry breaking"),
    ("chenciner", "CH", "Chenciner"),
    ("resonance-1-1", "R1", "resonance 1:1"),
    ("resonance-1-2", "R2", "resonance 1:2"),
    ("resonance-1-3", "R3", "resonance 1:3"),
    ("resonance-1-4", "R4", "resonance 1:4"),
    ("fold-flip", "LPPD", "fold and period doubling"),
    ("fold-symmetry-breaking", "LPSB", "fold and symmetry breaking"),
    ("fold-neimark-sacker", "LPNS", "fold and Neimark-Sacker"),
    ("flip-neimark-sacker", "PDNS", "period doubling and Neimark-Sacker"),
    ("symmetry-breaking-neimark-sacker", "SBNS", "symmetry breaking and Neimark-Sacker"),
    ("double-neimark-sacker", "NSNS", "two Neimark-Sacker"),
    ("bogdanov-takens", "BT", "Bogdanov-Takens"),
    ("generalized-hopf", "GH", "generalized Hopf"),
    ("zero-hopf", "ZH", "zero-Hopf"),
    ("double-hopf", "HH", "double Hopf"),
    ("border-fold", "BLP", "border and fold"),
    ("border-flip", "BPD", "border and period doubling"),
    ("border-symmetry-breaking", "BSB", "border and symmetry breaking"),
    ("border-neimark-sacker", "BNS", "border and Neimark-Sacker"),
    ("double-border", "BB", "two borders"),
    ("degenerate-border", "DB", "degenerate border"),
)
#: kinds of points of codimension two on loci of borders
_ALONG_BORDERS = (
    "border-fold",
    "border-flip",
    "border-symmetry-breaking",
    "border-neimark-sacker",
    "double-border",
)
CODIMENSION_TWO: dict[str, Kind] = {
    name: Kind(name, label, text=text, marker="o", filled=False, border=name in _ALONG_BORDERS)
    for name, label, text in _ROWS
}
#: kinds at which a multiplier is on the unit circle (an eigenvalue on the imaginary axis)
CRITICAL: frozenset[str] = frozenset(kind.name for kind in (*MULTIPLIERS, *CODIMENSION_TWO.values())) - {
    "double-border",
    "degenerate-border",
}
BY_NAME: dict[str, Kind] = {kind.name: kind for kind in KINDS}
LABELS: dict[str, str] = {kind.name: kind.label for kind in KINDS}
BORDERS: tuple[str, ...] = tuple(kind.name for kind in KINDS if kind.border)
#: names in files up to version 0.2 -> current names
RENAMED = {"chatter": "vanishing-event"}


def kind_named(name: str, own: Mapping[str, Kind] = BY_NAME) -> Kind:
    """Return the kind of this name, looked up in `own`, then among the built-in kinds; an unknown name gives a plain kind with label US."""
    return own.get(name) or BY_NAME.get(name) or CODIMENSION_TWO.get(name) or Kind(name, "US")


def checked(kinds: Iterable[Kind] | None) -> tuple[Kind, ...]:
    """Check the kinds that a diagram looks for, and return them; None gives the built-in ones.

    Raises
    ------
    ValueError
        If `kinds` is no list, an entry is no :class:`~contvines.Kind` or has no test function, or two kinds share a name or a label.
    """
    if not (kinds is None or isinstance(kinds, Iterable)):
        raise ValueError(
            f"kinds is a {type(kinds).__name__}; expected a list, kinds=[*contvines.KINDS, yours]"
        )
    chosen = KINDS if kinds is None else tuple(kinds)
    names: dict[str, Kind] = {}
    for kind in chosen:
        if not isinstance(kind, Kind):
            raise ValueError(f"kinds: {kind!r} is not a contvines.Kind; use kinds=[*contvines.KINDS, yours]")
        if BY_NAME.get(kind.name) is not kind:
            if kind.test is None:
                raise ValueError(
                    f"kinds: {kind.name} has no test function; give it one, test=lambda point: ..."
                )
            used = (*KINDS, *CODIMENSION_TWO.values(), *names.values())
            if any(kind.name == other.name or kind.label == other.label for other in used):
                raise ValueError(
                    f"kinds: the name {kind.name!r} or the label {kind.label!r} is used by another kind; choose others"
                )
        names[kind.name] = kind
    return chosen


def critical(found: object, kind: str) -> object:
    """Return a solution whose critical multipliers are set exactly on the unit circle (eigenvalues: on the axis), if its kind has such multipliers.

    Parameters
    ----------
    found : object
        A solution, for example an orbit.
    kind : str
        Kind of the special point.
    """
    if kind in CRITICAL and isinstance(found, Critical):
        return found.critical(Settings.critical)
    return found
