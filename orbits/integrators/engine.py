"""Which integrator integrates declared machines: heyoka, or scipy where heyoka is not installed or `CONTVINES_PAGES=scipy` asks for it."""

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
"""Names of the integrators, as `CONTVINES_PAGES` says them, and their files."""


class EngineMissing(ImportError):
    """The integrator asked for is not installed."""


@cache
def engine() -> ModuleType:
    """The module with `Values`, `Flight`, `Flights`, `Watch` and `Run`; what each does is said in `orbits.integrators`.

    Raises
    ------
    EngineMissing
        If `CONTVINES_PAGES` names an integrator that is not installed, or none.
    """
    asked = os.environ.get("CONTVINES_PAGES", "")
    if asked and asked not in MODULES:
        raise EngineMissing(f"CONTVINES_PAGES={asked}: say {' or '.join(MODULES)}, or leave it out")
    there = find_spec("heyoka") is not None
    if asked == "heyoka" and not there:
        raise EngineMissing(
            f"CONTVINES_PAGES=heyoka, which is not installed: {HOW.format(pip_install('machines'))}"
        )
    if not (asked or there):
        print(
            f"heyoka is not installed: SciPy integrates the motions, about fifty times slower; {HOW.format(pip_install('machines'))}",
            file=sys.stderr,
        )
    chosen = asked or ("heyoka" if there else "scipy")
    return import_module(f"orbits.integrators.{MODULES[chosen]}")
