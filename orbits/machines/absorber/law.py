"""The absorber's numbers as those of a level cavity with equal walls."""

from __future__ import annotations

from orbits.machines.cavity.law import Law


def law(par):
    """The numbers of the equations of motion."""
    a = (1.0 + par[4]) * par[2] * par[3]
    return Law(par[0], par[5], a, -a, 0.0, par[1], par[1], 1.0, -1.0)


def rate(par, slope):
    """Their derivatives along a direction `slope` of the parameters."""
    da = (1.0 + par[4]) * (par[2] * slope[3] + par[3] * slope[2]) + par[2] * par[3] * slope[4]
    return Law(slope[0], slope[5], da, -da, 0.0, slope[1], slope[1], 0.0, 0.0)
