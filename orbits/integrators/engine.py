"""Choice of the integrator of declared machines: heyoka, or SciPy if heyoka is missing or `CONTVINES_PAGES=scipy` is set."""

from __future__ import annotations

import os
import sys
from functools import cache
from importlib import import_module
from importlib.util import find_spec
from types import ModuleType

from contvines.shared.on_demand import pip_install

HOW = "{0} (Linux), or conda install heyoka.py -c conda-forge (macOS, Windows)"

MODULES = {"heyoka": "heyoka", "scipy": "solve_ivp"}
"""Values of `CONTVINES_PAGES`, and the modules of the integrators."""


class EngineMissing(ImportError):
    """The requested integrator is not installed."""


@cache
def engine() -> ModuleType:
    """Return the module with `Values`, `Flight`, `Flights`, `Watch` and `Run`, as `orbits.integrators` describes them.

    Raises
    ------
    EngineMissing
        If `CONTVINES_PAGES` names an integrator that is unknown or not installed.
    """
    asked = os.environ.get("CONTVINES_PAGES", "")
    if asked and asked not in MODULES:
        raise EngineMissing(f"CONTVINES_PAGES={asked}: say {' or '.join(MODULES)}, or leave it out")
    installed = find_spec("heyoka") is not None
    if asked == "heyoka" and not installed:
        raise EngineMissing(
            f"CONTVINES_PAGES=heyoka, which is not installed: {HOW.format(pip_install('machines'))}"
        )
    if not (asked or installed):
        print(
            f"heyoka is not installed: SciPy integrates the motions, about fifty times slower; {HOW.format(pip_install('machines'))}",
            file=sys.stderr,
        )
    chosen = asked or ("heyoka" if installed else "scipy")
    return import_module(f"orbits.integrators.{MODULES[chosen]}")
