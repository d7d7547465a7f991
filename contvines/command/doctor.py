"""`contvines doctor`: versions, core, extras, and a continuation whose result is known in closed form."""

from __future__ import annotations

import math
from importlib.util import find_spec
from typing import Any

import typer

from contvines.command.frame import tell
from contvines.command.options import JsonOption
from contvines.continuation.settings import Settings
from contvines.shared.on_demand import pip_install

EXTRAS = {
    "machines": ("heyoka",),
    "proofs": ("flint", "mpmath"),
    "units": ("pint",),
    "tables": ("pandas", "xarray", "h5netcdf", "networkx"),
    "surveys": ("dask", "distributed"),
    "report": ("plotly",),
}
"""Modules that each extra of pyproject.toml brings."""


def doctor(json: JsonOption = False) -> None:
    """Print versions, the core that computes, the extras that are installed, and the result of a self-test.

    The self-test follows the symmetric motion of an absorber to its fold and
    compares it with the closed form; it takes about a second. Exit status 1
    if it fails.
    """
    from contvines.provenance import provenance

    made = provenance()
    extras = {name: all(find_spec(part) for part in parts) for name, parts in EXTRAS.items()}
    test = self_test()
    if json:
        tell(made, {**made, "extras": extras, "self_test": test})
    else:
        for name, value in made.items():
            typer.echo(f"{name:>10}  {value}")
        for name, there in extras.items():
            way = "installed" if there else f"missing; {pip_install(name)} adds it"
            typer.echo(f"{name:>10}  {way}")
        verdict = "passed" if test["passed"] else "FAILED"
        typer.echo(
            f" self-test  {verdict}: fold at amplitude {test['found']:.12g}, closed form {test['closed_form']:.12g}"
        )
    if not test["passed"]:
        raise typer.Exit(1)


def self_test() -> dict[str, Any]:
    """The fold of the absorber's symmetric motion, found by continuation and in closed form.

    Returns
    -------
    dict
        "passed", "found" and "closed_form" (amplitudes).

    Notes
    -----
    The fold is the lowest point of the slow invariant manifold (Youssef, Karoui, Leine, symmetric periodic motions).
    """
    import contvines
    from orbits import Absorber
    from orbits.theory.manifolds import activation, friction_level, impact_loss

    absorber = Absorber(restitution=0.76, friction=0.5, gravity=0.211, mass_ratio=0.006)
    graph = contvines.diagram(
        absorber.symmetric_orbit(amplitude=0.55), over="amplitude", within=(0.2, 0.6), depth=0
    )
    expected = float(activation(impact_loss(0.76), friction_level(0.5, 0.211, 0.006)).amplitude)
    folds = [point.value for point in graph.special.values() if point.kind == "fold"]
    found = min(folds, key=lambda value: abs(value - expected), default=math.nan)
    return {
        "passed": bool(abs(found - expected) < Settings.located * expected),
        "found": float(found),
        "closed_form": expected,
    }
