"""The numbers of a cavity's equations from its parameters."""

from __future__ import annotations

import math

from orbits.machines.cavity.law import Law

AMPLITUDE, RESTITUTION_LEFT, RESTITUTION_RIGHT, FRICTION_LEFT, FRICTION_RIGHT = range(5)
GRAVITY, MASS_RATIO, FREQUENCY, SLOPE, DISTANCE_LEFT, DISTANCE_RIGHT = range(5, 11)


def law(par):
    """The numbers of the equations of motion: a_s = (1 + eps) mu_s g cos(slope), b = (1 + eps) g sin(slope)."""
    whole, g = 1.0 + par[MASS_RATIO], par[GRAVITY]
    cosine, b = math.cos(par[SLOPE]), whole * g * math.sin(par[SLOPE])
    return Law(
        par[AMPLITUDE],
        par[FREQUENCY],
        whole * par[FRICTION_LEFT] * g * cosine + b,
        b - whole * par[FRICTION_RIGHT] * g * cosine,
        b,
        par[RESTITUTION_LEFT],
        par[RESTITUTION_RIGHT],
        par[DISTANCE_LEFT],
        -par[DISTANCE_RIGHT],
    )


def rate(par, slope):
    """Their derivatives along a direction `slope` of the parameters."""
    weight = (1.0 + par[MASS_RATIO]) * par[GRAVITY]
    d_weight = (1.0 + par[MASS_RATIO]) * slope[GRAVITY] + par[GRAVITY] * slope[MASS_RATIO]
    cosine, sine = math.cos(par[SLOPE]), math.sin(par[SLOPE])
    d_normal = d_weight * cosine - weight * sine * slope[SLOPE]
    db = d_weight * sine + weight * cosine * slope[SLOPE]
    return Law(
        slope[AMPLITUDE],
        slope[FREQUENCY],
        d_normal * par[FRICTION_LEFT] + weight * cosine * slope[FRICTION_LEFT] + db,
        db - d_normal * par[FRICTION_RIGHT] - weight * cosine * slope[FRICTION_RIGHT],
        db,
        slope[RESTITUTION_LEFT],
        slope[RESTITUTION_RIGHT],
        slope[DISTANCE_LEFT],
        -slope[DISTANCE_RIGHT],
    )
