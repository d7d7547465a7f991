"""Kind: what a special point is called and drawn as, and how it is found, verified, classified and followed. Built-in kinds and users' own."""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

from ..continuation.settings import hinted

if TYPE_CHECKING:
    from ..continuation.engine import Solved
    from ..continuation.layout import Aim
    from .located import Located
    from .point_on_branch import Point, PointOnBranch
    from .segment import Segment


@dataclass(frozen=True, eq=False)
class Test:
    """A test function that passes zero on a segment.

    Attributes
    ----------
    function : Aim or callable
        Number of a solved point.
    index : int
        Rank of a multiplier among those of its sort, or which margin.
    jump : float
        The zero is given up where the function changes by more than this over a small part of the segment.
    """

    __test__ = False  # no test of pytest's
    function: Aim | Callable[[Solved], float]
    index: int = 0
    jump: float = float("inf")


class Classified(NamedTuple):
    """Normal form of a special point: which side, the coefficient (a number, or a function that computes it when asked), remarks."""

    criticality: str | None = None
    coefficient: float | Callable[[], float | None] | None = None
    remarks: tuple[str, ...] = ()


Sides = tuple[str | None, float | None]
"""What a user's kind may return in the place of `Classified`: criticality and coefficient."""
NAME = re.compile(r"[a-z][a-z0-9-]*")
LABEL = re.compile(r"[A-Z][A-Z0-9]*")
MARKERS = tuple("*os^vDpdhHPXx+|<>8.,1234_")
"""As matplotlib calls them."""


@hinted
@dataclass(frozen=True, eq=False)
class Kind:
    """A kind of special point.

    Along a branch the test function is evaluated at every point. Where it changes its sign between two points, or the parabola through
    three values passes zero, its zero is located by a safeguarded secant on the branch, verified, labelled and classified.

    Parameters
    ----------
    name : str
        As in files, JSON and :meth:`contvines.Graph.of_kind`: small letters, digits and hyphens.
    label : str
        What labels begin with: capital letters, as ``LP`` of LP1, LP2 ...
    test : callable, optional
        point -> float, zero at the special point and changing its sign there with a slope that is not zero. The point is a
        ``PointOnBranch``: ``point.u``, ``point.value``, ``point.parameters``,
        ``point.multipliers``, ``point.margins``, ``point.jacobian``, ``point.tangent``, ``point.measure(name)``.
    text : str
        For people; by default the name without hyphens.
    marker : str
        In pictures, as matplotlib calls it: one of ``* o s ^ v D p d h H P X x + | < > 8 . , 1 2 3 4 _``.
    filled : bool
    verify : callable, optional
        point -> True or False: whether a located zero is of this kind, as where the sign of another number decides.
    classify : callable, optional
        point -> (criticality, coefficient): "supercritical", "subcritical" or None, and a number or None.
    locus : callable, optional
        point -> float: the condition that ``contvines.locus`` adds to the equations, often the test itself. Its point has no tangent.
    ends : bool
        Branches end there.
    border, tests, find, leaves, nothing, without
        Of built-in kinds: what one test function does not tell, and sentences for where nothing leaves.

    Raises
    ------
    ValueError
        If the name, the label or the marker cannot be used, or ``test``, ``verify``, ``classify`` or ``locus`` is no function. While a
        diagram is made: if one of them fails or returns something else than it should, but NaN, with which a test says nothing.
    """

    name: str
    label: str
    test: Callable[[Point], float] | None = None
    text: str = ""
    marker: str = "*"
    filled: bool = True
    verify: Callable[[Point], bool] | None = None
    classify: Callable[[PointOnBranch], Classified | Sides] | None = None
    locus: Callable[[Point], float] | str | None = None
    ends: bool = False
    # of built-in kinds
    border: bool = False  # a margin vanishes there, and a branch ends
    tests: Callable[[Segment, Sequence[Located]], list[Test]] | None = None  # several test functions
    find: Callable[[Segment, Sequence[Located]], list[Located]] | None = None  # in the place of tests
    leaves: str = (
        ""  # "branch", "doubled", "cycles", "circle" or "beyond": see contvines.graph.schedule_branches
    )
    nothing: str = ""  # a sentence where no branch leaves
    without: str = ""  # a sentence where a branch leaves for which the problem has no equations

    def __post_init__(self) -> None:
        if not (isinstance(self.name, str) and NAME.fullmatch(self.name)):
            raise ValueError(
                f"kind {self.name!r}: a name has small letters, digits and hyphens, for example 'neutral-saddle'"
            )
        if not (isinstance(self.label, str) and LABEL.fullmatch(self.label)):
            raise ValueError(
                f"kind {self.name}: label = {self.label!r}; expected capital letters, for example 'NSD'"
            )
        for role in ("test", "verify", "classify", *(["locus"] if self.test is not None else [])):
            given = getattr(self, role)
            if given is not None and not callable(given):
                raise ValueError(f"kind {self.name}: {role} = {given!r} is no function of a point")
        if self.marker not in MARKERS:
            raise ValueError(
                f"kind {self.name}: marker = {self.marker!r}; expected one of matplotlib's: {' '.join(MARKERS)}"
            )
        if not self.text:
            object.__setattr__(self, "text", self.name.replace("-", " "))

    def look(self) -> dict[str, str | bool]:
        """Label, text and mark as JSON scalars: what files keep of a user's kind."""
        return {
            "name": self.name,
            "label": self.label,
            "text": self.text,
            "marker": self.marker,
            "filled": self.filled,
        }
