"""Tolerances of machines and motions, in groups by purpose.

Users need not set them: they follow from double precision and from lengths and speeds in a machine's own units, which they refer to.
Users choose the settings of a continuation (`contvines.Settings`). Constants of floating-point arithmetic are in `orbits.arguments`, limits
of parameters in the machines' tables.
"""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Solving:
    """Convergence of Newton's method to a motion.

    Attributes
    ----------
    residual, scaled : float
        Largest residual of a solution; the second for solutions from a simulation or a guess, relative to unknowns above 1.
    last_step : float
        Largest change of unknowns in the last step.
    near, rounding : float
        A step below `near` is also the last one if the residual after it is below `rounding`.
    free_step : float
        A step below this length is accepted even if the residual grows.
    longest_flight : float
        Longest flight, in the clock; if a flight is longer, the iteration has diverged.
    shift : float
        Relative change of the parameter in the first secant or in a difference quotient.
    mesh_error : float
        Error of the mesh of cycles without events, by collocation.
    equilibrium : float
        Largest distance of an equilibrium from a state at which a motion has come to rest, relative to 1 + size of the state.
    safe_product : float
        Largest product of the factors' norms for which the multipliers of the product of all factors are accurate enough.
    """

    residual: float = 1e-10
    scaled: float = 1e-9
    last_step: float = 1e-12
    near: float = 1e-9
    rounding: float = 1e-14
    free_step: float = 1e-7
    longest_flight: float = 1e3
    shift: float = 1e-6
    mesh_error: float = 1e-9
    equilibrium: float = 1e-3
    safe_product: float = 1e5


@dataclass(frozen=True)
class Events:
    """Numbers that count as zero in the search for events, in simulation and in flights between two nodes.

    Attributes
    ----------
    zero : float
        Differences of gaps and phases below this, relative to 1 + size of the states, are roundoff.
    simultaneous : float
        A quantity below this, relative to 1 + its rate, vanishes together with another one; hops below this height have accumulated.
    touch : float
        Rate below which a surface is touched and not crossed; a slower impact vanishes.
    slow : float
        Speed at a wall (squared, if compared with a height) below which impacts may be accumulating.
    hop : float
        Longest clock to the top of a hop whose end may be missed so close to its beginning; in a longer hop other events may come first.
    leave : float
        Clock after which a quantity that starts from zero without a rate exceeds roundoff.
    at_end : float
        Share of a flight at its ends: a guard that vanishes there vanishes at that end.
    at_rest : float
        Range of a state that does not move; also the largest shift over a period of a motion that returns.
    """

    zero: float = 1e-12
    simultaneous: float = 1e-11
    touch: float = 1e-7
    slow: float = 1e-6
    hop: float = 1e-2
    leave: float = 1e-5
    at_end: float = 1e-9
    at_rest: float = 1e-8


@dataclass(frozen=True)
class Growing:
    """Sizes near a border at which an event appears or vanishes.

    Attributes
    ----------
    first : float
        Clock, or speed, of the component that grows from zero beyond a border, in the first guess.
    short : float
        Clock of a stick, or between a turn and the stick after it, that is about to vanish.
    close : float
        Clock between two events of one contact that leaves no space for another event.
    """

    first: float = 2e-3
    short: float = 1e-4
    close: float = 1e-2


@dataclass(frozen=True)
class Bordering:
    """The neighbourhood of borders, and branches that begin there. Distances in the parameter are in its unit, sizes in the machine's own.

    Attributes
    ----------
    sizes : tuple of tuples of float
        Sizes of the component that grows beyond a border, from large to small: each tuple is one attempt.
    distances : tuple of float
        Distances from a border at which the branch that ends there is solved.
    simulated_at : tuple of float
        Distances in the parameter at which simulation begins, the second if the first finds nothing; near the slip of a rest only the second.
    regular, turning, slipping : tuple of float
        Distances at which a motion is solved: with regular equations at the border; on a branch that turns back close to it; and for the
        stick-slip motion near rest.
    simultaneous : float
        Margins, speeds and durations below this vanish together; motions that differ by less are the same.
    certain : float
        Margins below this may be zero: their signs are determined further away.
    unresolved : float
        Speed after an impact below which the next events cannot be resolved, because its square is roundoff.
    slow : float
        Speeds of impacts, or distances of turns from a wall, below this show an accumulation of impacts.
    placed : float
        Parameter values that differ by less are the same.
    growing : float
        Smallest growth of a margin per distance.
    steep : float
        Change of the nodes with the parameter beyond which a fold is close.
    least_flight : float
        Shortest flight of a guess, in the clock.
    """

    sizes: tuple[tuple[float, ...], ...] = ((2e-3, 2e-4, 2e-5), (1e-4, 2e-5), (2e-6, 2e-7), (2e-8,))
    distances: tuple[float, float] = (1e-4, 1e-5)
    simulated_at: tuple[float, float] = (1e-6, 1e-7)
    regular: tuple[float, ...] = (1e-8, 1e-7, 1e-6)
    turning: tuple[float, ...] = (1e-5, 1e-6)
    slipping: tuple[float, ...] = (1e-4, 1e-3)
    simultaneous: float = 1e-7
    certain: float = 1e-8
    unresolved: float = 1e-5
    slow: float = 1e-3
    placed: float = 1e-10
    growing: float = 1e-4
    steep: float = 1e4
    least_flight: float = 1e-6


@dataclass(frozen=True)
class Rounding:
    """Accuracy of derivatives of a cycle's rounds near a border, from which the branches that leave there are determined.

    Attributes
    ----------
    sure : float
        Largest relative error of a useful derivative.
    decided : float
        Share of the largest determinant below which the sign of a determinant is uncertain.
    """

    sure: float = 1e-3
    decided: float = 1e-2


@dataclass(frozen=True)
class Simulating:
    """Evaluation of simulated motions. Distances of points are relative to 1 + size of the points.

    Attributes
    ----------
    nudge : float
        Small displacements: in differences, of the neighbour whose growth is measured, of the velocity between two values of a sweep.
    whole_period : float
        Forcing periods that differ by less from a whole number, or from a given time, are equal to it.
    returned, returned_page, returned_many : float
        Largest distance of two points of a motion that has returned; for integrated motions; for many motions simulated together.
    nearly : float
        Largest distance of points that may be a return; also of a settled point from the solved motion to which it belongs.
    closed : float
        Distance of a return that is possible only on a cycle, stable or unstable.
    one : float
        Largest distance of equal points or nodes, and of equal motions in closed form.
    same : float
        Largest distance of two descriptions of one motion, and of equal integrated motions: near a graze the error is a square root.
    far : float
        Distance of neighbours beyond which the growth of small differences cannot be measured.
    wait : float
        Longest clock without an event of a self-excited machine.
    falling : float
        Distance from a known motion below which an approaching motion settles on it.
    neutral : float
        Multipliers this close to the unit circle neither attract nor repel.
    settled : float
        Relative change of an oscillator that has settled, between two comparisons.
    may_hold : float
        Friction that lacks less than this share of the forces may hold.
    resting : float
        Share of the space between walls; a motion that reaches less is at rest.
    steady : float
        Share of the displacement by which the displacements of a creeping motion may differ.
    lost_growth : float
        Growth factor used when a stick has made two neighbours equal.
    at_once : float
        Phase from a touch to the stick that follows it.
    late : float
        Share of the time for which a chaotic motion was followed; motions that settled later than this ended a chaotic transient.
    lives : float
        Mean lives of a chaotic transient for which a motion is followed that may still settle.
    peak : float
        Phases of a peak that differ by less are equal: the peak is accurate to the square of it.
    """

    nudge: float = 1e-7
    whole_period: float = 1e-9
    returned: float = 1e-6
    returned_page: float = 1e-5
    returned_many: float = 1e-8
    nearly: float = 1e-3
    closed: float = 1e-9
    one: float = 1e-7
    same: float = 1e-5
    far: float = 1e-2
    wait: float = 1e4
    falling: float = 1e-2
    neutral: float = 1e-6
    settled: float = 1e-13
    may_hold: float = 1e-9
    resting: float = 1e-6
    steady: float = 1e-3
    lost_growth: float = 1e-3
    at_once: float = 1e-6
    late: float = 0.125
    lives: float = 4.0
    peak: float = 1e-8


@dataclass(frozen=True)
class Replaying:
    """Agreement of a simulation with a computed orbit.

    Attributes
    ----------
    followed : float
        Largest deviation of a simulation that follows an orbit at a border.
    agreed : float
        Deviation below which no second test is needed.
    close : float
        Margins, and clocks of flights, below which roundoff may merge or swap two events; also the phase by which an event may be early.
    definite : float
        Strength of an event from which a simulation starts safely.
    wild : float
        Multipliers above this amplify roundoff strongly within a period.
    displaced, returned : float
        Distance of a start from a stable orbit, and distance at which it has returned; orbits are accurate to at least the first.
    nearer : tuple of (float, float)
        The same pairs for orbits that attract only from nearby.
    beside_folds, shrunk : tuple of float, float
        Distances of starts near folds, and the share of them that may remain.
    forgotten : float
        Share of a displacement that remains when its decay is measured.
    loss : float
        Distance from the orbit at which a simulation no longer follows it.
    rounding : float
        Roundoff of a simulated node.
    slope, slope_error : float
        First step of differences of the return map, and the estimated error of a derivative that needs no smaller step.
    """

    followed: float = 1e-6
    agreed: float = 1e-9
    close: float = 1e-4
    definite: float = 1e-2
    wild: float = 1e3
    displaced: float = 1e-6
    returned: float = 1e-8
    nearer: tuple[tuple[float, float], ...] = ((1e-8, 1e-9), (1e-10, 1e-8), (1e-11, 1e-8))
    beside_folds: tuple[float, ...] = (1e-7, 1e-8)
    shrunk: float = 1e-2
    forgotten: float = 1e-7
    loss: float = 1e-4
    rounding: float = 1e-15
    slope: float = 1e-5
    slope_error: float = 2e-10


@dataclass(frozen=True)
class Designing:
    """Estimates from measurements, searches for the best value, and redundant data.

    Attributes
    ----------
    difference : float
        Relative step of differences while parameters are estimated.
    effect : float
        Smallest step, relative to the span of the limits, of differences for the accuracy of estimates.
    estimated, flat : float
        Relative change of parameters and residuals, and gradient, at which an estimate ends.
    independent : float
        Ratio of the smallest to the largest effect of parameters below which the data do not determine all of them.
    accuracy, level : float
        Accuracy of a best value, relative to the search interval; and of the outcome there.
    agreement : float
        Largest relative difference of a number given in two ways, or of two responses of one motion (printed data are rounded).
    narrow : float
        Smallest step towards the largest response, relative to the interval.
    exhausted : float
        Share of the energy lost per period below which a decay has ended.
    endless : float
        Amplitude above which a response counts as unbounded.
    """

    difference: float = 1e-5
    effect: float = 1e-6
    estimated: float = 1e-12
    flat: float = 1e-14
    independent: float = 1e-10
    accuracy: float = 1e-3
    level: float = 1e-6
    agreement: float = 1e-3
    narrow: float = 1e-3
    exhausted: float = 1e-9
    endless: float = 1e12


@dataclass(frozen=True)
class Proving:
    """Guidance of proofs by floating-point numbers; no proved statement depends on these.

    Attributes
    ----------
    near : float
        Largest distance of equal nodes: of proof and computation, or of an orbit and its mirror image.
    rounded : float
        Newton corrections below this may stop shrinking: they are roundoff.
    short : float
        Clock of a flight whose ends may be merged.
    narrow : float
        Half-width of a tile about a special point from which floating-point numbers can continue.
    least_tile, graded : float
        Smallest share of a tile in a piece, and the factor by which it may be smaller near special points.
    inside : float
        Fraction of a piece at which its side of a special point is determined.
    overlap : float
        Share of a smallest tile by which the last tile passes the end.
    rough : float
        Relative error of a determinant below which another arithmetic also separates it from 0.
    critical : float
        Multipliers this close to the unit circle are separated from it by exact eigenvectors.
    real : float
        Relative imaginary part of a real multiplier.
    mixed, singular : float
        Condition number from which eigenvectors are nearly parallel, and from which a basis is singular.
    largest : float
        Numbers above this are out of range, because their squares overflow.
    """

    near: float = 1e-6
    rounded: float = 1e-12
    short: float = 1e-3
    narrow: float = 1e-12
    least_tile: float = 1e-6
    graded: float = 1e-8
    inside: float = 1e-4
    overlap: float = 1e-3
    rough: float = 1e-3
    critical: float = 1e-9
    real: float = 1e-20
    mixed: float = 1e3
    singular: float = 1e12
    largest: float = 1e280


@dataclass(frozen=True)
class Stepping:
    """Steps from event to event along closed forms; the native core has the same numbers (`native/`).

    Attributes
    ----------
    forever : float
        Longest time of one call, in forcing periods.
    chatter : float
        Time for all further impacts of a chatter, below which the absorber is put to rest.
    still : float
        Speed after an impact, or time, that counts as zero.
    least_speed : float
        Smallest speed of an impact; roundoff may leave less.
    leave : float
        Shortest time after a zero before the search for the next one.
    slip : float
        Largest phase error of a slip relative to the instant at which friction yields: nodes solve for it.
    """

    forever: float = 1e7
    chatter: float = 1e-7
    still: float = 1e-13
    least_speed: float = 1e-30
    leave: float = 1e-8
    slip: float = 1e-6


@dataclass(frozen=True)
class Integrating:
    """Relative and absolute error of a step of SciPy's integrator (heyoka works to roundoff)."""

    relative: float = 1e-13
    absolute: float = 1e-14


@dataclass(frozen=True)
class Formulas:
    """Tests of a machine file's formulas, of a structure's matrices, and of roots of polynomials.

    Attributes
    ----------
    same : float
        Largest relative difference of two evaluations of one formula, or of a matrix and its transpose.
    zero : float
        Share of the largest value below which an effect, or a squared natural frequency, is zero.
    real : float
        Relative imaginary part of a real root.
    runaway : float
        Size of a state beyond which the motion, not a formula, is the cause of an undefined value.
    """

    same: float = 1e-8
    zero: float = 1e-12
    real: float = 1e-9
    runaway: float = 1e8


@dataclass(frozen=True)
class Theory:
    """Tolerances of the method of multiple scales.

    Attributes
    ----------
    rounding : float
        Coefficients and squared amplitudes below this, relative to the largest, are roundoff.
    off_end : float
        Distance (radians, or velocity) from an end of a manifold's piece, where its slope is infinite.
    relative, absolute : float
        Error of a step in the integration of the slow flow.
    """

    rounding: float = 1e-14
    off_end: float = 1e-6
    relative: float = 1e-9
    absolute: float = 1e-11


SOLVING = Solving()
EVENTS = Events()
GROWING = Growing()
BORDERING = Bordering()
ROUNDING = Rounding()
SIMULATING = Simulating()
REPLAYING = Replaying()
DESIGNING = Designing()
PROVING = Proving()
STEPPING = Stepping()
INTEGRATING = Integrating()
FORMULAS = Formulas()
THEORY = Theory()
