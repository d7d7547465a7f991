"""Short name of `orbits.theory.multiple_scales`."""

from orbits.theory.multiple_scales import *  # noqa: F403
from orbits.theory.multiple_scales import __all__ as __all__
