"""The old name of :mod:`contvines.problems.protocol`."""

import sys

from .problems import protocol

sys.modules[__name__] = protocol
