"""Design figures, and the scales of a physical machine."""

from orbits.design.figures import SCALE, Design
from orbits.design.scales import Scales

__all__ = ["SCALE", "Design", "Scales"]
