"""Tolerances of problems made of Python callables. Users set none of them; those of a diagram are :class:`contvines.Settings`."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class DerivativeSettings:
    """What decides about derivatives, noise and breaks of a user's functions.

    Attributes
    ----------
    roundoff : float
        Differences: relative error, noise or width that is rounding of single numbers.
    rounded : float
        Differences: part of a row's size, or of its change, that is rounding of its terms.
    cancelled, mixed : float
        Differences: units in the last place of values up to which a change of them, and a change of a change, is rounding of terms that cancel.
    agree : float
        Derivatives: relative difference from differences at which the complex step, or a derivative that is given, counts as wrong.
    faint : float
        Derivatives: part of the largest row below which a row has no size of its own.
    aside : float
        Derivatives: distance, in lengths over which the function bends, from a start at which nothing is special any more.
    spacing : float
        Noise: between the first samples, in lengths; each table after that is a thousand times closer.
    steep : float
        Noise: part of a function's change above which what seems to be a step is a steep piece.
    brief : float
        Noise: seconds of a call that is not measured twice.
    felt, believed : float
        Noise: of a solution, relative to its size, that may be why a branch ends; more than can be believed.
    leap, kink : float
        Breaks: of values and of slopes, relative to what a row changes by.
    """

    roundoff: float = 1e-13
    rounded: float = 1e-12
    cancelled: float = 1e3
    mixed: float = 1e6
    agree: float = 1e-6
    faint: float = 1e-9
    aside: float = 1e-3
    spacing: float = 1e-6
    steep: float = 1e-4
    brief: float = 1e-4
    felt: float = 1e-6
    believed: float = 1e-4
    leap: float = 1e-6
    kink: float = 1e-3


@dataclass(frozen=True)
class ScaleSettings:
    """What decides about the way from a guess to a solution, and about sizes of unknowns seen from there.

    Attributes
    ----------
    near : float
        Newton's method: relative size of a correction from which on full steps are safe, and slow ones are those at a solution.
    close : float
        Newton's method: relative size of a correction after which a point is good enough.
    shortest : float
        Newton's method: part of a step below which a way leads nowhere.
    moves : float
        Scales: part of the length over which the equations bend, or of its size, by which an unknown has to move to have moved.
    barely : float
        Scales: part of its own size below which a length, or a move of an unknown in which the equations do not bend, is none.
    travelled : float
        Scales: part of the interval below which nothing was seen of it.
    faint : float
        Scales: part of its length up to which an unknown that began at zero was moved by what `close` leaves.
    rounding : float
        Scales: part of other unknowns, of what an equation feels, or of a length that is rounding.
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
    """What decides whether states, images and margins are equal.

    Attributes
    ----------
    same : float
        Points, relative to their size, that are one; disagreement of an equation with its mirror image, relative to a row, that is none.
    image : float
        Distance of the images of a point of order one below which two symmetries are one.
    cancelled : float
        Part of the largest size of a row that large terms which cancel may leave.
    vanishes, step : float
        Part of their change over a small step, in units of the solution, below which margins vanish; that step.
    """

    same: float = 1e-7
    image: float = 1e-9
    cancelled: float = 1e-13
    vanishes: float = 1e-3
    step: float = 1e-5


@dataclass(frozen=True)
class SimulationSettings:
    """What decides what starts of u' = F(u, p) settle on; all relative to the sizes of the unknowns.

    Attributes
    ----------
    relative, absolute : float
        Errors of a step of the integrator.
    beside : float
        Distance from an equilibrium at which a motion begins in its place, and at which two equilibria are one.
    still, far : float
        Distance that counts as rest, and at which a motion has escaped.
    """

    relative: float = 1e-8
    absolute: float = 1e-10
    beside: float = 1e-3
    still: float = 1e-5
    far: float = 1e4


@dataclass(frozen=True)
class LinearSettings:
    """Accuracy of linear systems and eigenvalues; residuals are relative.

    Attributes
    ----------
    real : float
        Imaginary part, relative to the largest eigenvalue, that is rounding.
    conditioned : float
        Condition of a Jacobian up to which its inverse is the reference for its eigenvalues.
    eigenvalues : float
        Relative accuracy of ARPACK's; residual of a trial solution that tells what a matrix costs.
    refined, enough, kept : float
        Factors: residual at which a solution is good, at which it will do, and at which it will do with the factors of an earlier Jacobian.
    gain : float
        Factors: by how much refinement with those has to shrink the residual each time.
    border : float
        Factors: size of the last row where the bordered matrix is factorised as a whole; part of its terms below which a Schur complement is rounding.
    shift, beside : float
        Factors: shifts, relative to the largest entry, of a singular matrix, and of one at its own eigenvalue.
    iterated, tolerated, growth : float
        Krylov methods: accuracy asked for; one that will do where rounding allows no more; what is added to it for each unit by which the solution is larger than the side.
    rough : float
        Krylov methods: residual of a number that says only how near a singular matrix is.
    aside : float
        Krylov methods: shift of a matrix that is singular to the last bit.
    """

    real: float = 1e-9
    conditioned: float = 1e8
    eigenvalues: float = 1e-8
    refined: float = 1e-13
    enough: float = 1e-9
    kept: float = 1e-11
    gain: float = 1e-2
    border: float = 1e-8
    shift: float = 1e-14
    beside: float = 1e-10
    iterated: float = 1e-11
    tolerated: float = 1e-4
    growth: float = 1e-12
    rough: float = 1e-6
    aside: float = 1e-9


DERIVATIVES = DerivativeSettings()
SCALES = ScaleSettings()
IDENTITY = IdentitySettings()
SIMULATION = SimulationSettings()
LINEAR = LinearSettings()
