"""Tolerances of identity and of what counts as known, which nobody sets; the others are those of :class:`contvines.Settings`."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Identity:
    """When two values of the parameter, or two solutions, are one, in parts of `Settings.same`.

    Attributes
    ----------
    stated : float
        Of values whose errors are stated; the errors come on top of it.
    unstated : float
        Of values of which none is stated.
    exact : float
        Of solutions to roundoff: those that differ by more are two, though they count as the same.
    """

    stated: float = 1e-4
    unstated: float = 1e-2
    exact: float = 1e-3


@dataclass(frozen=True)
class Coverage:
    """In which part of the interval responses are known.

    Attributes
    ----------
    least : float
        Of the interval: gaps that are shorter together are not simulated, and a response is known in spite of them.
    """

    least: float = 1e-3


IDENTITY = Identity()
COVERAGE = Coverage()
