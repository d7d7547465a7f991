"""Tolerances of pictures."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Drawing:
    """What is shown.

    Attributes
    ----------
    slack : float
        Part of the limits of an axis, or of the values on it, that is rounding.
    smallest, largest : float
        Sizes of multipliers that are shown: a graze sends one to infinity.
    blocked : float
        Cost of a place of a label that lies on another one.
    """

    slack: float = 1e-9
    smallest: float = 1e-4
    largest: float = 1e4
    blocked: float = 1e6


DRAWING = Drawing()
