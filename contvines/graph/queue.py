"""Pending: a branch that is waiting to be traced."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum

import numpy as np

from ..continuation.engine import Solved
from ..problems.protocol import Problem


class Origin(StrEnum):
    """From what a branch is reached."""

    START = "start"  # of the diagram: both ways
    SWITCH = "switch"  # the first points of a departure from a branch point
    BORDER = "border"  # a solution on the other side of a border: both ways
    ROOT = "root"  # a more symmetric solution to which a side branch has come back: both ways
    REST = "rest"  # a border, beyond which the same equations go on: one way


@dataclass
class Pending:
    """A branch that is waiting to be traced.

    Attributes
    ----------
    problem : Problem
    u, p : ndarray, float
        Where to begin.
    tangent : ndarray or None
    kind : Origin
    depth : int
        Switches used so far.
    source : str or None
        Label of the branch from which it was reached.
    point : str or None
        Label of the special point at which it was reached.
    note : str
        For the switch.
    real : bool or None
        None: the margins decide.
    origin, ahead, back : Solved or None
        Of a departure.
    first_step : float or None
    reached : bool
        A branch of these solutions was traced in the meantime: it has come to the border from the other side.
    """

    problem: Problem
    u: np.ndarray
    p: float
    tangent: np.ndarray | None = None
    kind: Origin = Origin.START
    depth: int = 0
    source: str | None = None
    point: str | None = None
    note: str = ""
    real: bool | None = None
    origin: Solved | None = None
    ahead: Solved | None = None
    back: Solved | None = None
    first_step: float | None = None
    reached: bool = False
