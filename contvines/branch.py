"""The old name of :mod:`contvines.branches.branch`."""

import sys

from .branches import branch

sys.modules[__name__] = branch
