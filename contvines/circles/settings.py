"""Tolerances of invariant circles."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class CircleSettings:
    """What decides where circles are and where they end.

    Attributes
    ----------
    step, least_step : float
        Differences: their length, relative to the sizes of the section, of the unknowns and of the parameter, and the least one beside a small circle.
    crossing : tuple of float
        Differences: lengths, relative to the size of the parameter, over which multipliers at the birth are compared; a fold, or the end of the
        pair, may be near.
    least_parameter : float
        Differences: smallest size of a parameter.
    solved : float
        Newton's method: residual, relative to the size of the circle.
    rounded, rough : float
        Newton's method: residual that does not shrink any more, relative to the size of the section, and at most relative to that of the circle.
    beginning : float
        Family: part of the usual first amplitude below which no circle is looked for.
    smooth, torn : float
        Ends: the last harmonics, relative to the first, of a circle that has enough points, and beyond which it has broken.
    apart : float
        Ends: by how much its images miss a circle between its points, relative to its radius; beyond that there is none.
    displaced : float
        Simulation: displacement, relative to the radius, whose growth or decay says whether a circle is stable.
    settled : float
        Simulation: difference of the rotation numbers of all and of half the returns that have settled.
    far, same : float
        Simulation: distance of a motion that runs away, and of returns that are one, relative to the size of the section.
    """

    step: float = 1e-6
    least_step: float = 1e-13
    crossing: tuple[float, ...] = (1e-5, 1e-6, 1e-7, 1e-8)
    least_parameter: float = 1e-3
    solved: float = 1e-10
    rounded: float = 1e-11
    rough: float = 1e-4
    beginning: float = 1e-4
    smooth: float = 1e-7
    torn: float = 3e-3
    apart: float = 1e-3
    displaced: float = 1e-3
    settled: float = 1e-11
    far: float = 1e3
    same: float = 1e-8


CIRCLES = CircleSettings()
