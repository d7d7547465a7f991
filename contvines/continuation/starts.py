"""Checks of the start of a run: interval, problem, and the solution from which the first branch is followed."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Protocol, cast, runtime_checkable

import numpy as np

from contvines.shared.numbers import ROUNDED

from ..problems.abilities import Named, Rough, Started
from ..problems.protocol import MEMBERS, Problem
from .engine import Engine, Solved
from .settings import SOLUTION

if TYPE_CHECKING:
    from collections.abc import Iterable

    from numpy.typing import ArrayLike

    from ..problems.scales import Scales


@runtime_checkable
class Orbit(Protocol):
    """Protocol of a solution with a problem and a start."""

    def problem(self, parameter: str, /) -> Problem: ...
    def seed(self, problem: Problem, /) -> tuple[np.ndarray, float]: ...


@runtime_checkable
class PointOfBranch(Protocol):
    """Protocol of a special point of a graph with its problem attached, or of a locus, whose `value` has both parameters."""

    @property
    def attached(self) -> Problem: ...
    @property
    def u(self) -> np.ndarray: ...
    @property
    def value(self) -> float | tuple[float, float]: ...


def check_interval(within: Iterable[float]) -> tuple[float, float]:
    """Return the interval as two floats.

    Raises
    ------
    ValueError
        If it is no pair of increasing finite numbers.
    """
    try:
        lower, upper = (float(value) for value in within)
    except (TypeError, ValueError):
        raise ValueError(
            f"within = {within!r} must be two numbers, the ends of the parameter interval"
        ) from None
    if not (math.isfinite(lower) and math.isfinite(upper)):
        raise ValueError(f"within = [{lower}, {upper}] must have finite ends")
    if not lower < upper:
        raise ValueError(
            f"within = [{lower}, {upper}] is empty or reversed; the first end must be the smaller one"
        )
    return lower, upper


def problem_and_start(
    seed: object, over: str | None, u: ArrayLike | None = None, p: float | None = None
) -> tuple[Problem, ArrayLike, float]:
    """Return (problem, u, p) for a start.

    Parameters
    ----------
    seed : Orbit, PointOfBranch or Problem
        An orbit, a special point, or a problem with ``u0`` and ``p0``.
    over : str or None
        Name of the continuation parameter; None for the problem's own.
    u, p : optional
        Replace the unknowns and the parameter value of the seed.

    Raises
    ------
    TypeError
        If the seed is no orbit, special point or complete problem.
    ValueError
        If there is no such parameter, the parameter is not named, or a problem has no start.
    """
    if isinstance(seed, PointOfBranch):
        value = seed.value[0] if isinstance(seed.value, tuple) else seed.value
        u, p, seed = seed.u if u is None else u, value if p is None else p, seed.attached
        if over not in (None, seed.parameter) and over in seed.parameters:
            p, seed = seed.parameters[over], seed.against(over, {seed.parameter: float(p)})
    if hasattr(seed, "kernels") and hasattr(seed, "dimension"):
        problem = complete(seed)
        if over is not None and over != problem.parameter and over in problem.parameters:
            problem = problem.against(over)
        if over is not None and over != problem.parameter:
            choices = f"; its parameters are {', '.join(problem.parameters)}" if problem.parameters else ""
            raise ValueError(f"over = {over!r}, but this problem continues in {problem.parameter!r}{choices}")
        if u is None or p is None:
            if not isinstance(problem, Started):
                raise ValueError(
                    f"{'u' if u is None else 'p'} = None: a {type(seed).__name__} has no start of its own; give u and p, or an "
                    "orbit instead"
                )
            u, p = (problem.u0 if u is None else u), (problem.p0 if p is None else p)
        return problem, u, float(p)
    if not isinstance(seed, Orbit):
        raise TypeError(
            f"the seed must be an orbit, a special point or a problem with u0 and p0, not {type(seed).__name__}"
        )
    names = list(getattr(seed, "parameters", None) or ("amplitude",))
    if over is None and len(names) > 1:
        choices = ", ".join(map(repr, names))
        raise ValueError(f"over = None: name the parameter to continue in, one of {choices}")
    over = over or names[0]
    problem = seed.problem(over)
    own_u, own_p = seed.seed(problem)
    return problem, own_u if u is None else u, float(own_p if p is None else p)


def complete(problem: object) -> Problem:
    """Check that a problem has all members of the protocol, and return it.

    Raises
    ------
    TypeError
        If members are missing; the message lists them.
    ValueError
        If it has a spectrum without multipliers.
    """
    missing = [name for name in MEMBERS if not hasattr(problem, name)]
    if missing:
        raise TypeError(
            f"{type(problem).__name__} lacks {', '.join(missing)}; derive it from contvines.ProblemDefaults, which "
            "has defaults for all optional members"
        )
    whole = cast(Problem, problem)
    if (
        whole.spectrum in ("map", "flow")
        and whole.dimension
        and not (whole.n_multipliers or isinstance(problem, Rough))
    ):
        raise ValueError(
            f"{type(problem).__name__} has spectrum = {whole.spectrum!r} and n_multipliers = 0; give the number of its multipliers, or "
            'spectrum = "none" for branches without stability'
        )
    return whole


def solve_start(engine: Engine, u: ArrayLike, p: float) -> Solved:
    """Solve for the first point of a branch near (u, p).

    Raises
    ------
    ValueError
        If an end of the interval is no valid value of the parameter, the start lies outside, or Newton's method does not converge from it.
    """
    name = engine.problem.parameter
    try:
        for end in (engine.lower, engine.upper):
            engine.problem.check_value(name, end)
    except ValueError as error:
        raise ValueError(f"within = [{engine.lower:.10g}, {engine.upper:.10g}]: {error}") from None
    u = np.asarray(u, dtype=float).reshape(-1)
    p = float(p)
    if not engine.lower <= p <= engine.upper:
        raise ValueError(
            f"the start {name} = {p:.10g} lies outside of within = [{engine.lower:.10g}, {engine.upper:.10g}]; "
            "widen the interval or move the start"
        )
    if len(u) != engine.n or not np.all(np.isfinite(u)):
        raise ValueError(f"the start must be {engine.n} finite numbers, not {u}")
    found = engine.start(u, p)
    if found is None:
        if different := differing_residuals(engine, u, p):
            raise ValueError(f"the start at {name} = {p:.10g}: {different}")
        residual = engine.residual(u, p)
        reason = f"does not converge (its residual is {residual:.3g})"
        if residual < SOLUTION.solved:
            reason = "is a solution, but the derivatives of the equations are zero or singular there, in the parameter, too"
        elif not residual < np.inf:
            trouble = getattr(engine.problem, "trouble", "")
            reason = "cannot be evaluated with its derivatives" + (f"; {trouble}" if trouble else "")
        raise ValueError(
            f"the start at {name} = {p:.10g} {reason}; give a better guess or another parameter value"
        )
    return found


def differing_residuals(engine: Engine, u: np.ndarray, p: float) -> str:
    """Return a sentence if the user's equations give different residuals in two evaluations at the same point; empty if not, or not evaluable."""
    problem = engine.problem
    if engine.compiled or not isinstance(problem, Rough):
        return ""
    from ..problems.functions import NotEvaluable, difference_text

    try:
        one, other = problem.residuals(u, p), problem.residuals(u, p)
    except NotEvaluable:
        return ""
    return difference_text(one, other)


def start_remark(engine: Engine, u: ArrayLike, p: float, found: Solved) -> str:
    """Return sentences on a start that was no solution (residual, and where the branch begins instead), and on unknowns of unknown size; empty if none.

    Parameters
    ----------
    engine : Engine
    u, p
        The given start.
    found : Solved
        The solution found from it.

    Raises
    ------
    ValueError
        If the solution is farther from the start than `Settings.escape`.
    """
    problem = engine.problem
    if engine.compiled or not isinstance(problem, Rough):
        return ""
    return "; ".join(
        part for part in (_moved_note(engine, u, p, found), _unscaled_note(problem, problem.scales)) if part
    )


def _name(problem: object, i: int) -> str:
    """Return the name of an unknown."""
    return problem.unknown_name(i) if isinstance(problem, Named) else f"u{i}"


def _unscaled_note(problem: object, scales: Scales | None) -> str:
    """Return a sentence on unknowns whose typical sizes cannot be derived at the start; empty if there are none."""
    if scales is None or not scales.untold:
        return ""
    names = ", ".join(_name(problem, i) for i in scales.untold[:3]) + (
        ", ..." if len(scales.untold) > 3 else ""
    )
    return f"the start does not show how large {names} may become: 1 is assumed; scale= sets another size"


def _moved_note(engine: Engine, u: ArrayLike, p: float, found: Solved) -> str:
    """Return a sentence on a start that was no solution; empty if it was one."""
    problem = engine.problem
    assert isinstance(problem, Rough)
    u = np.asarray(u, dtype=float).reshape(-1)
    moved = np.abs(found.u - u) / engine.scale[:-1]
    shift = abs(found.p - float(p)) / float(engine.scale[-1])
    if max(float(moved.max()), shift) < SOLUTION.moved:
        return ""
    size = float(np.abs(problem.residuals(u, float(p))).max())
    i = int(np.argmax(moved))
    began = found.u[i] if abs(found.u[i]) > ROUNDED * engine.scale[i] else 0.0
    place = f"{_name(problem, i)} = {began:.6g} instead of {u[i]:.6g}"
    guessed = np.maximum(engine.scale[:-1], np.abs(u))  # the guess gives the size of a solution at zero
    if not (np.abs(found.u - u) / guessed).max() <= engine.settings.escape:
        raise ValueError(
            f"the start given is no solution (the largest entry of F is {size:.2g}), and Newton's method ends far away, at "
            f"{place}; give a better guess or another parameter value"
        )
    position = place
    if shift >= SOLUTION.moved:
        position += f", {problem.parameter} = {found.p:.6g} instead of {float(p):.6g}"
    far = f", {moved[i]:.2g} of its typical size away" if moved[i] >= 0.1 else ""
    return f"the start given is no solution (the largest entry of F is {size:.2g}): the branch begins at {position}{far}"
