"""Machines that many tests ask, each written once: the numbers of the literature (r = 0.76, mu = 0.5, g = 0.211, eps = 0.006)."""

import contvines as cv
from orbits import Absorber, Coupled

STRONG = {"restitution": 0.76, "friction": 0.5, "gravity": 0.211, "mass_ratio": 0.006}
ABSORBER = Absorber(**STRONG)
COUPLED = Coupled(**STRONG, damping=1.0, forcing=2.47)


def absorber_graph(amplitude, within, **options):
    """The symmetric motion of the absorber and what leaves it."""
    return cv.diagram(ABSORBER.symmetric_orbit(amplitude), over="amplitude", within=within, **options)
