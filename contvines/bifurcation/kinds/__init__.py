"""The kinds of special points. Labels, marks in pictures, tables, legends, detection and switching follow from them."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from ...continuation.settings import Settings
from ...problems.abilities import Critical
from ..kind import Kind
from . import branch_point, fold, multipliers


def _border(name: str, label: str, marker: str, text: str = "", filled: bool = True) -> Kind:
    return Kind(name, label, text=text, marker=marker, filled=filled, border=True, leaves="beyond")


#: borders that are met at once take the first of these names
_BORDERS = (
    # friction holds what has come to rest, or lets it go
    _border("stick", "ST", "<", "turn to stick"),
    # a sliding velocity touches zero within a flight
    _border("velocity-graze", "VG", "v"),
    # a wall is touched without speed
    _border("wall-graze", "WG", ">"),
    # an impact loses its speed, or a stick or flight its duration
    _border("vanishing-event", "VE", "X"),
    # the surface of a switch is touched without speed
    _border("switch-graze", "SG", "d"),
    # events of two contacts happen at once
    _border("corner", "CO", "P", "two events at once"),
    # a solution comes to the surface between two pieces of the equations
    _border("switch", "SW", "d", filled=False),
    # the period of a cycle grows without bound
    _border("homoclinic", "HC", "H", "homoclinic orbit"),
    # a motion comes to touch an event that stops it
    _border("event", "EV", "8"),
)


USER = Kind("user", "US", text="user function", nothing="nothing leaves the zero of a user function")
"""A number that the user has named passes a value; see :mod:`contvines.bifurcation.kind`."""
END = Kind(
    "end",
    "EP",
    text="end of the interval",
    marker="|",
    filled=False,
    nothing="the interval ends here; no branch leaves",
)
KINDS: tuple[Kind, ...] = (
    fold.KIND,
    *multipliers.KINDS,
    branch_point.KIND,
    *_BORDERS,
    USER,
    END,
)
"""The built-in kinds along a branch, in the order in which they are asked."""

MULTIPLIERS = (fold.KIND, *multipliers.KINDS, branch_point.KIND)
# points of codimension two, found along a locus
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
#: one more margin vanishes there
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
#: names of files up to version 0.2 -> names of today
RENAMED = {"chatter": "vanishing-event"}


def kind_named(name: str, own: Mapping[str, Kind] = BY_NAME) -> Kind:
    """The kind of this name; a problem's own border kinds that are not in the table are borders drawn plainly."""
    return own.get(name) or BY_NAME.get(name) or CODIMENSION_TWO.get(name) or Kind(name, "US")


def checked(kinds: Iterable[Kind] | None) -> tuple[Kind, ...]:
    """The kinds that a diagram looks for.

    Raises
    ------
    ValueError
        If they are no list, one is no :class:`~contvines.Kind`, has no test function, or two share a name or a label.
    """
    if not (kinds is None or isinstance(kinds, Iterable)):
        raise ValueError(
            f"kinds is a {type(kinds).__name__}; a list is asked for, kinds=[*contvines.KINDS, yours]"
        )
    chosen = KINDS if kinds is None else tuple(kinds)
    names: dict[str, Kind] = {}
    for kind in chosen:
        if not isinstance(kind, Kind):
            raise ValueError(f"kinds: {kind!r} is no contvines.Kind; use kinds=[*contvines.KINDS, yours]")
        if BY_NAME.get(kind.name) is not kind:
            if kind.test is None:
                raise ValueError(
                    f"kinds: {kind.name} has no test function; test=lambda point: ... gives it one"
                )
            used = (*KINDS, *CODIMENSION_TWO.values(), *names.values())
            if any(kind.name == other.name or kind.label == other.label for other in used):
                raise ValueError(
                    f"kinds: the name {kind.name!r} or the label {kind.label!r} is used by another kind; choose others"
                )
        names[kind.name] = kind
    return chosen


def critical(found: object, kind: str) -> object:
    """The solution with its critical multipliers on the unit circle (eigenvalues on the axis), if the special point is of a kind that has them."""
    if kind in CRITICAL and isinstance(found, Critical):
        return found.critical(Settings.critical)
    return found
