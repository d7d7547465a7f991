"""By how much the mesh of a solution moves a special point: the point is solved for on a mesh with intervals half as long.

On the plane across the branch at the point (beside it, where the equations are singular) both meshes have a solution. With s along the branch,
its parameter p and a number g that vanishes at the special point,

    p* on the finer mesh - p* = (p_finer - p) - (dp/ds) (g_finer - g) / (dg/ds),

the first order of Newton's method. Gauss collocation of degree m leaves 4^-m of the error there (Ascher, Mattheij and Russell 1995, section 5.4).
"""

from __future__ import annotations

import math
from typing import Protocol, runtime_checkable

import numpy as np
from numpy.typing import NDArray

from ..continuation.engine import Engine
from ..problems.abilities import Adaptive
from ..problems.protocol import BorderPoint

#: what the critical multiplier is at special points whose place it tells
CRITICAL = {"period-doubling": -1.0, "neimark-sacker": 1.0, "branch-point": 1.0, "symmetry-breaking": 1.0}
SINGULAR = ("branch-point", "symmetry-breaking")


@runtime_checkable
class Started(Adaptive, Protocol):
    """A problem on a mesh whose finer one begins with given unknowns."""

    u0: np.ndarray


class Special(BorderPoint, Protocol):
    """A special point of a branch."""

    @property
    def kind(self) -> str: ...
    @property
    def multipliers(self) -> NDArray[np.complex128]: ...


def mesh_error(engine: Engine, special: Special) -> float | None:
    """Error of the parameter at a special point, from a finer mesh; None where that cannot be obtained.

    Parameters
    ----------
    engine : Engine
        Of a problem on a mesh.
    special : SpecialPoint
    """
    problem, settings = engine.problem, engine.settings
    if not isinstance(problem, Started):
        return None
    u, p, tangent = special.u, float(special.value), engine.unit(special.tangent)
    singular = special.kind in SINGULAR
    here = None if singular else engine.across(u, p, tangent)
    beside = engine.across(*_moved(u, p, tangent, settings.offset), tangent)
    coarse = beside if singular else here
    if coarse is None or beside is None:
        return None
    problem.u0 = coarse.u
    finer = Engine(problem.refined(), engine.within, settings)
    direction = np.append(problem.halved(tangent[:-1], True), tangent[-1])
    fine = finer.across(problem.halved(coarse.u), coarse.p, direction)
    if fine is None:
        return None
    first = 0.0 if here is None else _vanishing(engine, special, here.row)
    second = _vanishing(engine, special, beside.row)
    missed = _vanishing(finer, special, fine.row) - (second if singular else first)
    found, along = abs(fine.p - coarse.p), abs(coarse.tangent[-1] / engine.inner(tangent, coarse.tangent))
    if missed:
        found += along * abs(missed) * settings.offset / abs(second - first) if second != first else math.inf
    return settings.mesh_caution * found if math.isfinite(found) else None


def _moved(u: np.ndarray, p: float, tangent: np.ndarray, by: float) -> tuple[np.ndarray, float]:
    return u + by * tangent[:-1], p + by * float(tangent[-1])


def _vanishing(engine: Engine, special: Special, row: np.ndarray) -> float:
    """The number that vanishes at a special point, from a row near it; zero where the point is no more than its parameter."""
    if special.margin_index is not None:
        return float(row[2 * engine.m + special.margin_index])
    if special.kind not in CRITICAL:
        return 0.0
    spectrum = engine.spectrum(row)
    if special.kind == "neimark-sacker":
        pairs = special.multipliers[special.multipliers.imag > 0.0]
        pair = pairs[int(np.argmin(np.abs(np.abs(pairs) - 1.0)))]
        return float(np.abs(spectrum[int(np.argmin(np.abs(spectrum - pair)))])) - 1.0
    place = CRITICAL[special.kind]
    return float(spectrum[int(np.argmin(np.abs(spectrum - place)))].real) - place
