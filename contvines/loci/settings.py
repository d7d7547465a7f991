"""Tolerances of loci and charts that nobody sets, by subject; those that users set are :class:`contvines.Settings`."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Places:
    """Places in the plane of two parameters, in parts of its sides or relative to the parameters.

    Attributes
    ----------
    same : float
        Distance of two solved places up to which they are one.
    end : float
        Distance from the end of a locus, or from a point on both of two loci, at which a place that was met otherwise is that one.
    """

    same: float = 1e-7
    end: float = 1e-5


@dataclass(frozen=True)
class Vanishing:
    """When a number at a solution is zero.

    Attributes
    ----------
    margin : float
        Margins, angles and parts of the interval below this vanish; along the locus of a border all of them do.
    singular : float
        A test, or the unfolding of a branch point, below this (in units of the equations): these are singular, and their solutions known to
        half the digits.
    critical : float
        Distance of a multiplier from the boundary, or of a pair from the real axis, at which it is there.
    double : float
        The same of a double multiplier, which is known to half of the digits.
    zero : float
        A test that is less than this part of its terms, or of what it is at the ends of its segment, is zero.
    nothing : float
        A test that is less at both ends of a segment is zero all along, but for rounding.
    beside, straight : float
        Distance from a border (in the metric) at which it is seen how its margins pass zero, and part of their changes on both sides by which those
        of one that passes it smoothly may differ.
    image, loose : float
        Relative distance of a motion from its image under a symmetry up to which it is its own; of one on a mesh, or from one that was simulated.
    """

    margin: float = 1e-8
    singular: float = 1e-7
    critical: float = 1e-5
    double: float = 1e-4
    zero: float = 1e-6
    nothing: float = 1e-9
    beside: float = 1e-4
    straight: float = 0.1
    image: float = 1e-5
    loose: float = 1e-3


@dataclass(frozen=True)
class Scaling:
    """Sizes of unknowns and parameters, and differences relative to them.

    Attributes
    ----------
    step : float
        Of differences of tests along a locus, and distance within which slopes are not worked out again; native/loci.hpp has the same.
    widest : float
        Largest step of the differences of a margin at a degenerate border.
    start : float
        Part of its interval: a second parameter that starts closer to zero says nothing of its size.
    unseen : float
        Typical sizes below this part of the largest one are those of zeros.
    """

    step: float = 1e-7
    widest: float = 8e-3
    start: float = 1e-6
    unseen: float = 1e-12


PLACES, VANISHING, SCALING = Places(), Vanishing(), Scaling()
