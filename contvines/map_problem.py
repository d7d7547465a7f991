"""The old name of :mod:`contvines.problems.maps`."""

import sys

from .problems import maps

sys.modules[__name__] = maps
