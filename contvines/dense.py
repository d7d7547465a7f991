"""The old name of :mod:`contvines.problems.dense`."""

import sys

from .problems import dense

sys.modules[__name__] = dense
