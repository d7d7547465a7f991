"""The name of version 0.1 of `orbits.design.scales`."""

from orbits.design.scales import *  # noqa: F403
from orbits.design.scales import Scales as Scales
