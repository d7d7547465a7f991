"""Design of machines: design figures, SI scales, families of machines, optimisation, transients."""

from orbits.design.choice import Choice, best
from orbits.design.family import Family
from orbits.design.figures import SCALE, Design
from orbits.design.scales import Scales

__all__ = ["SCALE", "Choice", "Design", "Family", "Scales", "best"]
