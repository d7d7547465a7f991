"""The old name of :mod:`contvines.problems.algebraic`."""

import sys

from .problems import algebraic

sys.modules[__name__] = algebraic
