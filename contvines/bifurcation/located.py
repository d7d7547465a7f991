"""Located: what was found on a stretch of a branch, and what that means for following it."""

from __future__ import annotations

import math
from dataclasses import dataclass
from enum import StrEnum

from ..continuation.engine import Solved
from .locate import Root

NOWHERE = (math.nan, math.nan)  # a bracket that is not known yet


class Role(StrEnum):
    """What a located point means for following the branch."""

    SPECIAL = "special"  # a special point of the branch
    BORDER = "border"  # a margin vanishes: the branch ends
    MEETING = "meeting"  # the branch comes back to the fixed space of a symmetry, and ends
    STOP = "stop"  # a function at whose zeros the user wants branches to end
    LEFT = "left"  # the branch leaves the interval between two points that lie in it
    UNRESOLVED = "unresolved"  # both ends of a segment, which is not halved any more, do not agree with what was found between
    PLAIN = "plain"  # just a point between two special points
    LEAP = "leap"  # the point before a step to another branch: to be traced again with shorter ones
    LANDING = "landing"  # the same, before a step that ends next to a meeting: with another one


@dataclass(frozen=True, eq=False)
class Located:
    """A point that was located on a chunk.

    Attributes
    ----------
    position : float
        Index of the point before it plus the fraction of the segment.
    kind : str
        See :mod:`contvines.bifurcation.kinds`; of a meeting that of the symmetry. Empty for a plain point, a leap, a landing and where the interval is left.
    index : int
        Which multiplier, margin, symmetry or user function.
    point : Solved
    bracket : (float, float)
    error : float
        Estimated error of the parameter value.
    role : Role
    name : str
        Of the user function.
    rounding : float
        Of a border, how far rounding of its margins may move the parameter value: no sign of a leap, but part of the error.
    astray : bool
        It is no special point: the segment has led from one branch to another.
    """

    position: float
    kind: str
    index: int
    point: Solved
    bracket: tuple[float, float]
    error: float
    role: Role = Role.SPECIAL
    name: str = ""
    rounding: float = 0.0
    astray: bool = False

    @classmethod
    def at(
        cls, root: Root, kind: str, index: int = 0, role: Role = Role.SPECIAL, astray: bool = False
    ) -> Located:
        """What a located zero is; nobody has put it on its branch yet."""
        kind = "" if astray else kind
        return cls(root.position, kind, index, root.point, NOWHERE, root.error, role, astray=astray)

    @property
    def ends_branch(self) -> bool:
        """Whether what lies behind it is left out."""
        return self.role in (Role.BORDER, Role.MEETING, Role.STOP, Role.LEFT)
