"""What the functions of users' kinds say of a point; what is no answer is refused in a sentence."""

from __future__ import annotations

import math
import numbers
from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from .kind import Classified, Kind

if TYPE_CHECKING:
    from .point_on_branch import Point, PointOnBranch

SIDES = ("supercritical", "subcritical", None)


def number_of(
    kind: Kind, role: str, function: Callable[..., Any], point: Point, at: Mapping[str, float]
) -> float:
    """A test or a condition at a point; NaN where arithmetic fails.

    Parameters
    ----------
    kind : Kind
    role : str
        "test" or "locus".
    function : callable
    point : Point
    at : mapping
        Where it is, for sentences.

    Raises
    ------
    ValueError
        If it fails for a reason of its own, or returns no real number.
    """
    try:
        found = _answer(kind, role, function, point, at)
    except (ArithmeticError, np.linalg.LinAlgError):
        return math.nan
    number = found.item() if isinstance(found, np.ndarray | np.generic) and np.size(found) == 1 else found
    if isinstance(number, bool) or not isinstance(number, numbers.Real):
        raise _no_answer(kind, role, found, at, "a real number")
    return float(number)


def verified(kind: Kind, point: Point, at: Mapping[str, float]) -> bool:
    """Whether a located zero is of the kind.

    Raises
    ------
    ValueError
        If `verify` of a user's kind fails, or returns neither True nor False.
    """
    if kind.verify is None:
        return True
    if kind.test is None:
        return kind.verify(point)
    found = _answer(kind, "verify", kind.verify, point, at)
    if not isinstance(found, bool | np.bool_):
        raise _no_answer(kind, "verify", found, at, "True or False")
    return bool(found)


def classified(kind: Kind, point: PointOnBranch, at: Mapping[str, float]) -> Classified:
    """The normal form of a special point.

    Raises
    ------
    ValueError
        If `classify` of a user's kind fails, or returns no pair of criticality and coefficient.
    """
    if kind.classify is None:
        return Classified()
    found = _answer(kind, "classify", kind.classify, point, at) if kind.test else kind.classify(point)
    if isinstance(found, Classified):
        return found
    try:
        side, coefficient = found
        assert side in SIDES and (coefficient is None or isinstance(coefficient, numbers.Real))
    except (AssertionError, TypeError, ValueError):
        wanted = '(criticality, coefficient): "supercritical", "subcritical" or None, and a number or None'
        raise _no_answer(kind, "classify", found, at, wanted) from None
    return Classified(side, None if coefficient is None else float(coefficient))


def _answer(
    kind: Kind, role: str, function: Callable[..., Any], point: Point, at: Mapping[str, float]
) -> Any:
    try:
        return function(point)
    except (ArithmeticError, np.linalg.LinAlgError) as error:
        if role in ("test", "locus"):
            raise
        raise _failed(kind, role, error, at) from error
    except Exception as error:
        raise _failed(kind, role, error, at) from error


def _failed(kind: Kind, role: str, error: Exception, at: Mapping[str, float]) -> ValueError:
    return ValueError(f"kind {kind.name}: its {role} fails at {_place(at)}: {type(error).__name__}: {error}")


def _no_answer(kind: Kind, role: str, found: object, at: Mapping[str, float], wanted: str) -> ValueError:
    return ValueError(
        f"kind {kind.name}: its {role} returns {found!r} at {_place(at)}; {wanted} is asked for"
    )


def _place(at: Mapping[str, float]) -> str:
    return ", ".join(f"{name} = {value:.10g}" for name, value in at.items())
