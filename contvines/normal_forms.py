"""The old name of :mod:`contvines.switching.normal_forms`."""

import sys

from .switching import normal_forms

sys.modules[__name__] = normal_forms
