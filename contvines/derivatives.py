"""The old name of :mod:`contvines.problems.derivatives`."""

import sys

from .problems import derivatives

sys.modules[__name__] = derivatives
