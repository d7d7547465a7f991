"""Tolerances of special points that nobody sets, by subject; those that users set are :class:`contvines.Settings`."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Locating:
    """Zeros of test functions on a segment, and when a place counts as known.

    Attributes
    ----------
    bracket : float
        Width of the final bracket, in parts of the segment.
    jump : float
        A test that differs by more than this across the final bracket has a jump there.
    rounding : float
        Part of a number by which another one differs through rounding: an image from a signed permutation of the unknowns, say.
    halved : float
        Part of the last Newton correction that may be left.
    noisy : float
        Times the noise of the equations: places are no better than this, and matrices no nearer to singular ones.
    past : float
        How far past the circle (the axis) a multiplier is more than rounding; native/scan.hpp has the same.
    faster : float
        Times the rate that three neighbouring segments tell that a pair may go at on the middle one; native/scan.hpp has the same.
    bent : float
        Condition of the second derivatives from which one Newton step for a branch point says nothing; the demo "chu" meets singular ones.
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
        How far off such a point may be, in amplitudes, where two branches cross at a small angle; and if nothing is found at that.
    """

    slanted: float = 300.0
    grazing: float = 1e4


@dataclass(frozen=True)
class Limits:
    """One-sided limits at borders; distances are in the metric, differences of polynomials are parts of their largest coefficient.

    Attributes
    ----------
    tangent : float
        How far the cosine of a tangent to the extrapolated one may be from 1; else it is rounding.
    distances : tuple of float
        Spacings of the points before a border from which is extrapolated.
    nearest : tuple of float
        Spacings at which it shows that what grew is bounded after all.
    agreeing : float
        Difference of a limit from what is computed at the border, where both are one.
    smooth, growing : float
        Difference of extrapolations from two spacings that have converged: without and with multipliers that grow without bound. The latter
        also from what is computed at the border, and of products of a margin and what grows as its inverse.
    straight : float
        Distance before a short segment up to which its branch is looked for along the tangent.
    unbounded : float
        Size that stands for a multiplier that grows without bound.
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
        Distance (in the metric) of points beside a special point, from which derivatives along the branch are taken; the longest that is tried.
    enough : float
        Relative difference of derivatives from two radii that asks for no other.
    narrowest : float
        Smallest radius of samples, in units of the unknowns.
    cutoff : float
        Singular values below this part of the largest are zeros.
    unsure : float
        A coefficient whose error exceeds this part of it, or of its natural size, is not known.
    digits : float
        The same of the coefficients at points of codimension two, from samples, and of derivatives along the branch from a step and half of it.
    resonant : float
        Angle between a pair and a strong resonance at which the coefficient no longer decides.
    """

    step: float = 1e-3
    enough: float = 1e-10
    narrowest: float = 4e-3
    cutoff: float = 1e-9
    unsure: float = 1e-3
    digits: float = 1e-2
    resonant: float = 2e-3


LOCATING, LEAVING, LIMITS, NORMAL_FORMS = Locating(), Leaving(), Limits(), NormalForms()
