"""Tolerances of problems made of Python callables. Users do not set them; user settings are in :class:`contvines.Settings`."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class DerivativeSettings:
    """Tolerances for derivatives, noise, kinks and jumps of a user's functions.

    Attributes
    ----------
    roundoff : float
        Differences: relative error, noise or interval width at the level of rounding of single numbers.
    rounded : float
        Differences: rounding error of a row, relative to its size or its change.
    cancelled, mixed : float
        Differences: first differences of values below `cancelled` units in the last place, and second ones below `mixed`, count as rounding of
        terms that cancel.
    agree : float
        Derivatives: relative distance from differences above which the complex step, or a given derivative, counts as wrong.
    faint : float
        Derivatives: size of a row, relative to the largest one, below which it counts as zero.
    tested_at : float
        Derivatives: distance from the start, in lengths of the function, at which derivatives are tested: the start itself may be a special point.
    spacing : float
        Noise: distance between the first samples, in lengths of the function; each further table is a thousand times closer.
    steep : float
        Noise: steps above this part of a function's change count as steep pieces, not as noise.
    brief : float
        Time: seconds up to which the cost of a call is not measured a second time.
    noticed, largest : float
        Noise of a solution, relative to its size: above `noticed` it may be the reason why a branch ends; estimates are limited to `largest`.
    leap, kink : float
        Breaks: smallest jump of values, and smallest change of slopes, relative to the change of a row.
    """

    roundoff: float = 1e-13
    rounded: float = 1e-12
    cancelled: float = 1e3
    mixed: float = 1e6
    agree: float = 1e-6
    faint: float = 1e-9
    tested_at: float = 1e-3
    spacing: float = 1e-6
    steep: float = 1e-4
    brief: float = 1e-4
    noticed: float = 1e-6
    largest: float = 1e-4
    leap: float = 1e-6
    kink: float = 1e-3


@dataclass(frozen=True)
class ScaleSettings:
    """Tolerances of the damped Newton's method and of the learned scales.

    Attributes
    ----------
    near : float
        Newton's method: relative size of a correction below which full steps are safe, and slow convergence is accepted.
    close : float
        Newton's method: relative size of the last correction of a converged point.
    shortest : float
        Newton's method: smallest damping factor; below it the method fails.
    moves : float
        Scales: smallest movement of an unknown that counts, relative to its length or size.
    barely : float
        Scales: smallest length, or movement of an unknown in which the equations are linear, that counts, relative to the unknown's size.
    travelled : float
        Scales: smallest part of the interval that the parameter must cover for the trace to count.
    faint : float
        Scales: movements of an unknown from zero below this part of its length count as errors of the converged points (`close`).
    rounding : float
        Scales: an unknown below this part of the others, of the size with an effect on an equation, or of its length is a rounding error.
    """

    near: float = 1e-3
    close: float = 1e-7
    shortest: float = 1e-6
    moves: float = 1e-2
    barely: float = 1e-4
    travelled: float = 1e-3
    faint: float = 1e-6
    rounding: float = 1e-12


@dataclass(frozen=True)
class IdentitySettings:
    """Tolerances for the identity of states, symmetries and margins.

    Attributes
    ----------
    same : float
        Largest relative distance of equal points; largest disagreement of an equation with its mirror image, relative to the row.
    image : float
        Largest distance between the images of a point of order one under two symmetries that are equal.
    cancelled : float
        Rounding error of large terms that cancel, relative to the largest size of the row.
    vanishes, step : float
        A margin counts as zero if it is below the part `vanishes` of its change over a small step; that step, relative to the solution.
    """

    same: float = 1e-7
    image: float = 1e-9
    cancelled: float = 1e-13
    vanishes: float = 1e-3
    step: float = 1e-5


@dataclass(frozen=True)
class SimulationSettings:
    """Tolerances of the simulation of u' = F(u, p); all relative to the sizes of the unknowns.

    Attributes
    ----------
    relative, absolute : float
        Error tolerances of the integrator.
    offset : float
        Offset of a start that is itself an equilibrium; largest distance between equal equilibria.
    at_rest, far : float
        Largest movement of a motion at rest; distance from the origin at which a motion has escaped.
    """

    relative: float = 1e-8
    absolute: float = 1e-10
    offset: float = 1e-3
    at_rest: float = 1e-5
    far: float = 1e4


@dataclass(frozen=True)
class LinearSettings:
    """Accuracy of linear systems and eigenvalues; residuals are relative.

    Attributes
    ----------
    real : float
        Imaginary parts below this part of the largest eigenvalue are rounding errors.
    conditioned : float
        Largest condition number of a Jacobian whose inverse is used as the reference for its eigenvalues.
    eigenvalues : float
        Relative accuracy of ARPACK's eigenvalues; residual of the trial solution that decides whether a matrix is written out.
    refined, enough, reused : float
        Direct solvers: residual at which refinement stops; largest accepted residual; the same with the factors of an earlier Jacobian.
    gain : float
        Direct solvers: factor by which each refinement with the factors of an earlier Jacobian must reduce the residual.
    border : float
        Direct solvers: relative size of the last row if the whole bordered matrix is factorised; a Schur complement below this part of its terms is a
        rounding error.
    shift, offset : float
        Direct solvers: shift of a singular matrix, and distance of the shift of inverse iteration from its eigenvalue; relative to the largest entry.
    iterated, tolerated, growth : float
        Krylov methods: requested residual; largest accepted residual where rounding prevents a smaller one; addition to it for each unit of the ratio of
        the solution to the right-hand side.
    rough : float
        Krylov methods: requested residual of the distance from a singular matrix.
    singular : float
        Krylov methods: shift of a matrix that is singular to the last bit.
    """

    real: float = 1e-9
    conditioned: float = 1e8
    eigenvalues: float = 1e-8
    refined: float = 1e-13
    enough: float = 1e-9
    reused: float = 1e-11
    gain: float = 1e-2
    border: float = 1e-8
    shift: float = 1e-14
    offset: float = 1e-10
    iterated: float = 1e-11
    tolerated: float = 1e-4
    growth: float = 1e-12
    rough: float = 1e-6
    singular: float = 1e-9


DERIVATIVES = DerivativeSettings()
SCALES = ScaleSettings()
IDENTITY = IdentitySettings()
SIMULATION = SimulationSettings()
LINEAR = LinearSettings()
