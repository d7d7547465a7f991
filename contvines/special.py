"""The old name of :mod:`contvines.branches.special_point`."""

import sys

from .branches import special_point

sys.modules[__name__] = special_point
