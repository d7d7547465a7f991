"""Fixed tolerances of detection, location, switching and normal forms, by subject; users set those of :class:`contvines.Settings`."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Locating:
    """Location of zeros of test functions on a segment, and its accuracy.

    Attributes
    ----------
    bracket : float
        Width of the final bracket, relative to the segment.
    jump : float
        A test function that differs by more than this across the final bracket has a jump there.
    rounding : float
        Largest relative difference of two numbers that counts as rounding: for example of a symmetry from a signed permutation of the unknowns.
    halved : float
        Error of a solution, relative to the last Newton correction.
    noisy : float
        Factor on the noise of the equations: limit of the accuracy of positions, and of the distance to a singular matrix.
    past : float
        A multiplier (eigenvalue) is outside the circle (axis) from this distance on; less is rounding. Same value in native/scan.hpp.
    faster : float
        A pair may move on a segment this many times as fast as on it and its two neighbours. Same value in native/scan.hpp.
    bent : float
        Condition number of the matrix of second derivatives from which the Newton step for a branch point is not used; it is singular in the demo "chu".
    """

    bracket: float = 1e-12
    jump: float = 1e-2
    rounding: float = 1e-9
    halved: float = 1e-3
    noisy: float = 2e3
    past: float = 1e-10
    faster: float = 2.0
    bent: float = 1e6


@dataclass(frozen=True)
class Leaving:
    """First points of branches that leave a special point.

    Attributes
    ----------
    slanted, grazing : float
        Largest distance of a first point from the special point, in amplitudes: large where two branches cross at a small angle. The second value is
        tried if none is found with the first.
    """

    slanted: float = 300.0
    grazing: float = 1e4


@dataclass(frozen=True)
class Limits:
    """One-sided limits at borders; distances are in the metric, differences of polynomials are relative to their largest coefficient.

    Attributes
    ----------
    tangent : float
        Largest 1 - cosine between a computed tangent and the extrapolated one; else the computed one is rounding.
    distances : tuple of float
        Spacings of the points before a border that are used for extrapolation.
    nearest : tuple of float
        Spacings that show whether growing coefficients are bounded after all.
    agreeing : float
        Largest difference between a limit and the value computed at the border for which both count as equal.
    smooth, growing : float
        Difference of extrapolations from two spacings below which they have converged: without and with multipliers that grow without bound. The latter
        also bounds the difference from values computed at the border, and the variation of products of a margin and a coefficient that grows like its
        inverse.
    straight : float
        Largest distance before a short segment at which points of its branch are sought along the tangent.
    unbounded : float
        Size that represents a multiplier that grows without bound.
    """

    tangent: float = 1e-10
    distances: tuple[float, ...] = (4e-4, 5e-5, 6e-6, 8e-7, 1e-7)
    nearest: tuple[float, ...] = (1e-9, 1e-11, 1e-13)
    agreeing: float = 1e-7
    smooth: float = 1e-4
    growing: float = 1e-2
    straight: float = 3e-5
    unbounded: float = 1e15


@dataclass(frozen=True)
class NormalForms:
    """Coefficients of normal forms.

    Attributes
    ----------
    step : float
        Largest distance (in the metric) between a special point and points beside it, from which derivatives along the branch are computed.
    enough : float
        Relative difference of derivatives from two radii below which no other radius is tried.
    narrowest : float
        Smallest radius of samples, in units of the unknowns.
    cutoff : float
        Singular values below this part of the largest count as zeros.
    unsure : float
        Largest error of a coefficient, relative to it or to its natural size, with which it counts as known.
    digits : float
        The same for coefficients at points of codimension two, and for derivatives along the branch from a step and half of it.
    resonant : float
        Angle between a multiplier and a strong resonance below which a remark names the resonance.
    """

    step: float = 1e-3
    enough: float = 1e-10
    narrowest: float = 4e-3
    cutoff: float = 1e-9
    unsure: float = 1e-3
    digits: float = 1e-2
    resonant: float = 2e-3


LOCATING, LEAVING, LIMITS, NORMAL_FORMS = Locating(), Leaving(), Limits(), NormalForms()
