"""Fixed tolerances of loci and charts, by subject; user settings are in :class:`contvines.Settings`."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Places:
    """Distances in the plane of two parameters, relative to its sides or to the parameters.

    Attributes
    ----------
    same : float
        Largest distance of two solved points that are equal.
    end : float
        Largest distance of a less accurate point from the end of a locus, or from a common point of two loci, that is equal to it.
    """

    same: float = 1e-7
    end: float = 1e-5


@dataclass(frozen=True)
class Vanishing:
    """Tolerances below which a number at a solution counts as zero.

    Attributes
    ----------
    margin : float
        For margins, angles, and distances from the ends of an interval relative to its width.
    singular : float
        For tests, or the unfolding of a branch point (in units of the equations): below it the equations count as singular, and their solutions
        have half of the digits.
    critical : float
        For the distance of a multiplier from the stability boundary, or of a pair from the real axis.
    double : float
        The same for a double multiplier, which has half of the digits.
    zero : float
        For a test, relative to its terms or to its values at the ends of the segment.
    nothing : float
        A test that is smaller than this at both ends of a segment is zero along the whole segment, apart from rounding.
    offset, straight : float
        Distance from a border (in the metric) at which the margins on both sides are compared, and the largest relative difference of the two changes
        of a margin that passes zero smoothly.
    image, loose : float
        Largest relative distance of a symmetric motion from its image; the same for a motion on a mesh, or compared with a simulation.
    """

    margin: float = 1e-8
    singular: float = 1e-7
    critical: float = 1e-5
    double: float = 1e-4
    zero: float = 1e-6
    nothing: float = 1e-9
    offset: float = 1e-4
    straight: float = 0.1
    image: float = 1e-5
    loose: float = 1e-3


@dataclass(frozen=True)
class Scaling:
    """Step sizes of differences and limits of typical sizes, all relative.

    Attributes
    ----------
    step : float
        Step of the differences of tests along a locus, and distance within which slopes are reused; equal to that of native/loci.hpp.
    widest : float
        Largest step of the differences of a margin at a degenerate border.
    start : float
        The start of the second parameter is used as its typical size only if it is larger than this part of the interval.
    unseen : float
        Typical sizes below this part of the largest one belong to unknowns that are zero.
    """

    step: float = 1e-7
    widest: float = 8e-3
    start: float = 1e-6
    unseen: float = 1e-12


PLACES, VANISHING, SCALING = Places(), Vanishing(), Scaling()
