"""Tolerances of the search for coexisting motions: atlas, populations of maps, stable manifolds."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class AtlasSettings:
    """Tolerances of an atlas; lengths are relative to the interval.

    Attributes
    ----------
    narrow : float
        Width below which stable stretches, windows, and stretches between two changes of stability are left out; likewise branches
        that begin so near to a homoclinic orbit.
    narrow_chain : float
        Width below which a chain of meeting stretches, for example a cascade, is not followed beyond its ends.
    beyond : float
        Distance beyond a change of stability at which an atlas simulates.
    farthest : float
        Largest distance beyond the end of a stable stretch at which its motion is followed.
    offset : float
        Distance of starts from the motion that is followed, relative to the box of starts; without it a symmetric motion would stay symmetric.
    inside : float
        Smallest distance of a kicked start from the edge of the box, relative to the ray's length; and of a sample's probability from 0 and 1.
    """

    narrow: float = 1e-5
    narrow_chain: float = 1e-3
    beyond: float = 2e-3
    farthest: float = 1e-3
    offset: float = 1e-3
    inside: float = 1e-9


@dataclass(frozen=True)
class MapSettings:
    """Tolerances for the motions of a map; distances are relative to the box of starts.

    Attributes
    ----------
    returned : float
        Distance below which an iterate has returned to the first point of a cycle; step below which Newton's method has converged.
    near : float
        Distance from a known cycle below which a settled point belongs to it.
    spacing : float
        Distance between close returns of a chaotic motion beyond which each is tried as a guess of a cycle.
    far : float
        Distance from the box's centre beyond which a motion has escaped.
    """

    returned: float = 1e-9
    near: float = 1e-5
    spacing: float = 1e-3
    far: float = 1e4


@dataclass(frozen=True)
class ManifoldSettings:
    """Tolerances for growing stable manifolds; lengths are relative to the plane's size.

    Attributes
    ----------
    first : tuple of float
        Distances of the first point from the saddle, tried in this order until the linear prediction of its image is accurate.
    largest, smallest : float
        Limits of the circles' radii.
    corner : float
        Radius below which the curve may have a corner, for example where an impact begins to be missed; also the distance from a wall
        or the plane's edge at which a curve has reached it.
    on_curve : float
        Distance, relative to a circle's radius, below which an image lies on the curve.
    jump : float
        Distance, relative to a circle's radius: if the nearest image is further from the curve, the map is discontinuous.
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
