"""Tolerances of what coexists: where an atlas looks, starts of maps, basins and their boundaries."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class AtlasSettings:
    """Where an atlas looks. Lengths are parts of the interval.

    Attributes
    ----------
    narrow : float
        Stable stretches, windows, and stretches between two changes of what is stable that are narrower are left out, and branches that leave
        another one so near to a homoclinic orbit.
    narrow_chain : float
        Stretches that meet, as those of a cascade, and are narrower together, are not followed past their ends.
    beyond : float
        So far outside a stable stretch it is asked what the motion becomes.
    farthest : float
        At most so far past the end of a stable stretch its motion is followed.
    aside : float
        Part of the box of starts by which these are moved off the motion that is followed, for what is symmetric stays so.
    inside : float
        Part by which a start stays inside the box, and a sample's probability between 0 and 1.
    """

    narrow: float = 1e-5
    narrow_chain: float = 1e-3
    beyond: float = 2e-3
    farthest: float = 1e-3
    aside: float = 1e-3
    inside: float = 1e-9


@dataclass(frozen=True)
class MapSettings:
    """How the motions of a map are recognised. Distances are parts of the box of starts.

    Attributes
    ----------
    returned : float
        Distance of two points of a cycle that are one; last step of Newton's method.
    near : float
        A settled point so near to a solved cycle belongs to it.
    apart : float
        Places so far apart are looked at on their own when cycles are looked for in chaos.
    far : float
        A motion has run away.
    """

    returned: float = 1e-9
    near: float = 1e-5
    apart: float = 1e-3
    far: float = 1e4


@dataclass(frozen=True)
class ManifoldSettings:
    """How stable manifolds are grown. Lengths are parts of the plane's size.

    Attributes
    ----------
    first : tuple of float
        Distances of the first point from the saddle; the next one is tried where the images are not where its derivative has them.
    largest, smallest : float
        Radii of the circles.
    corner : float
        Radius below which the curve may have a corner, as where an impact begins to be missed.
    on_curve : float
        Part of a circle's radius: images so near to the curve lie on it.
    jump : float
        Part of a circle's radius: where the distance cannot be made smaller, the motion jumps.
    """

    first: tuple[float, ...] = (1e-4, 1e-5, 1e-6, 1e-7)
    largest: float = 1e-2
    smallest: float = 1e-6
    corner: float = 1e-3
    on_curve: float = 1e-9
    jump: float = 1e-3


ATLAS = AtlasSettings()
MAPS = MapSettings()
MANIFOLDS = ManifoldSettings()
