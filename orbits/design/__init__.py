"""Design: figures, scales, families of machines, the best choice, transients."""

from orbits.design.choice import Choice, best
from orbits.design.family import Family
from orbits.design.figures import SCALE, Design
from orbits.design.scales import Scales

__all__ = ["SCALE", "Choice", "Design", "Family", "Scales", "best"]
