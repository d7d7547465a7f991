"""Tolerances of the machines and of their motions, in groups by what they decide.

Nobody has to set them: they follow from double precision and from lengths and speeds in a machine's own units, in which all of them are
counted. What users choose are the settings of a continuation (`contvines.Settings`). Facts of floating point: `orbits.arguments`; limits of
parameters: the machines' tables.
"""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Solving:
    """When Newton's method has arrived at a motion.

    Attributes
    ----------
    residual, scaled : float
        Largest residual of a solution; of one found by simulation or from a guess, in units of its unknowns above 1.
    last_step : float
        Largest change of unknowns in the last step.
    near, rounding : float
        A smaller step is the last one, too, where the residual after it is rounding: less than `rounding`.
    free_step : float
        Length of a step that is taken even if the residual grows.
    longest_flight : float
        Clock of one flight beyond which the iteration has lost its way.
    shift : float
        Change of the parameter, relative, with which a secant or a difference begins.
    mesh_error : float
        Of cycles without events, by collocation.
    equilibrium : float
        How far from a state at which a motion has come to rest the equilibrium may be, relative to 1 + its size.
    safe_product : float
        Product of the factors' norms up to which their product keeps the multipliers that matter.
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
    """What is zero when an event is looked for, in simulation and in flights between two nodes.

    Attributes
    ----------
    zero : float
        Gaps and phases that differ by less, relative to 1 + the states, differ by rounding.
    together : float
        A quantity this close to zero, relative to 1 + its rate, vanishes together with another; hops that rise no higher have piled up.
    touch : float
        Rate below which a surface is touched, not crossed; an impact that is slower vanishes.
    slow : float
        Speed at a wall, squared where it is compared with a height, below which impacts may be piling up.
    hop : float
        Clock to the top of a hop whose end may be lost beside its beginning; on a longer one other events may come first.
    leave : float
        Clock after which a quantity that starts from zero without a rate has grown out of rounding.
    at_end : float
        Share of a flight, next to its ends, in which a guard that vanishes does so at that end.
    still : float
        Range of a state, or shift over a period, of what does not move.
    """

    zero: float = 1e-12
    together: float = 1e-11
    touch: float = 1e-7
    slow: float = 1e-6
    hop: float = 1e-2
    leave: float = 1e-5
    at_end: float = 1e-9
    still: float = 1e-8


@dataclass(frozen=True)
class Growing:
    """Sizes next to a border, at which an event appears or vanishes.

    Attributes
    ----------
    first : float
        Clock, or speed, of what grows from zero beyond a border, in the first guess.
    short : float
        Clock of a stick, or between a turn and the stick after it, that is about to vanish.
    close : float
        Clock between two events of one contact between which nothing else can be.
    """

    first: float = 2e-3
    short: float = 1e-4
    close: float = 1e-2


@dataclass(frozen=True)
class Bordering:
    """What is next to a border, and what begins there. Distances in the parameter are in its unit, sizes in the machine's own.

    Attributes
    ----------
    sizes : tuple of tuples of float
        Sizes of what grows beyond a border, from large to small: ways to try.
    beside : tuple of float
        Distances from a border at which the branch that ends there is looked at.
    away : tuple of float
        Distances in the parameter at which simulation begins, the second where the first finds nothing; next to where friction holds, the second.
    regular, turning, slipping : tuple of float
        Distances at which a motion is solved for: one whose equations are regular at the border, one whose branch turns back close to it, and
        the stick-slip motion beside rest.
    together : float
        Margins, speeds and durations so small vanish together; motions that differ by less are one.
    shown : float
        Margins so small may be zero: their signs are asked for further away.
    unresolved : float
        Speed of an impact after which margins do not show the way, the square of it.
    slow : float
        Speed of an impact, or distance of a turn from a wall, that says that they pile up.
    placed : float
        Distance in the parameter of places that are one.
    growing : float
        Least growth of a margin with the distance.
    steep : float
        Change of the nodes with the parameter beyond which a fold is close.
    least_flight : float
        Clock of a flight of a guess, at least.
    """

    sizes: tuple[tuple[float, ...], ...] = ((2e-3, 2e-4, 2e-5), (1e-4, 2e-5), (2e-6, 2e-7), (2e-8,))
    beside: tuple[float, float] = (1e-4, 1e-5)
    away: tuple[float, float] = (1e-6, 1e-7)
    regular: tuple[float, ...] = (1e-8, 1e-7, 1e-6)
    turning: tuple[float, ...] = (1e-5, 1e-6)
    slipping: tuple[float, ...] = (1e-4, 1e-3)
    together: float = 1e-7
    shown: float = 1e-8
    unresolved: float = 1e-5
    slow: float = 1e-3
    placed: float = 1e-10
    growing: float = 1e-4
    steep: float = 1e4
    least_flight: float = 1e-6


@dataclass(frozen=True)
class Rounding:
    """When derivatives of the rounds of a cycle beside a border decide what leaves there.

    Attributes
    ----------
    sure : float
        Relative error of a derivative that is of use.
    decided : float
        Part of the largest determinant below which one has no sign to rely on.
    """

    sure: float = 1e-3
    decided: float = 1e-2


@dataclass(frozen=True)
class Simulating:
    """What a simulation says of a motion. Distances of points are relative to 1 + the points.

    Attributes
    ----------
    nudge : float
        Small displacements: of differences, of the neighbour whose growth is measured, of the velocity from one value of a sweep to the next.
    whole : float
        Forcing periods that miss a whole number, or a given instant, by less do so by rounding.
    returned, returned_page, returned_many : float
        Distance of two points of a motion that has returned; of an integrated one; of one of many that are simulated at once.
    nearly : float
        Distance at which it may have returned, and at which a settled point belongs to a solved motion.
    closed : float
        Distance of a return that only a motion on a cycle has, be the cycle stable or not.
    one : float
        Distance of points, or nodes, that are one, and of motions that are known in closed form.
    same : float
        Distance of two descriptions of one motion, and of integrated motions that are one: grazes are known to the root of their error.
    far : float
        Distance of neighbours that tells nothing of small differences.
    wait : float
        Clock of a self-excited machine without an event after which none is waited for.
    falling : float
        Distance at which a motion that comes nearer falls onto a known one.
    neutral : float
        Multipliers this close to the circle neither attract nor repel.
    settled : float
        Relative change of an oscillator that has settled, from one look to the next.
    held : float
        Part of the forces: friction that is short of no more may hold.
    resting : float
        Part of the room between walls: what reaches less rests.
    steady : float
        Part of the way by which the ways of a creeping motion may differ.
    lost : float
        Factor that stands for the growth of a difference that a stick has lost.
    at_once : float
        Phase from a touch to the stick that follows it.
    late : float
        Part of the time for which motions that do not recur are followed: what recurs later has been like them until then.
    lives : float
        Mean lives of a chaotic transient for which one is waited for that may end.
    peak : float
        Phases of a peak that differ by less: the peak is known to the square of it.
    """

    nudge: float = 1e-7
    whole: float = 1e-9
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
    held: float = 1e-9
    resting: float = 1e-6
    steady: float = 1e-3
    lost: float = 1e-3
    at_once: float = 1e-6
    late: float = 0.125
    lives: float = 4.0
    peak: float = 1e-8


@dataclass(frozen=True)
class Replaying:
    """When simulation agrees with a claimed orbit.

    Attributes
    ----------
    followed : float
        Largest deviation of a simulation that follows an orbit at a border.
    agreed : float
        Deviation that needs no second look.
    close : float
        Margins, and clocks of flights, below which rounding may make one event of two, or swap them; phase by which an event may be early.
    definite : float
        Strength of an event from which a simulation starts without doubt.
    wild : float
        Multipliers above this blow rounding up within a period.
    displaced, back : float
        Distance of a start off a stable orbit, and at which it is back; an orbit is known to the first at least.
    nearer : tuple of (float, float)
        The same of orbits that attract from near by only.
    beside_folds, shrunk : tuple of float, float
        Distances of starts beside folds, of which no more than this part is to be left.
    forgotten : float
        Part of a displacement that is left when it is looked at again.
    loss : float
        Distance at which an orbit that is followed is lost.
    rounding : float
        Of a simulated node.
    slope, slope_error : float
        First step of differences of the return map, and the estimated error of a derivative that asks for no smaller one.
    """

    followed: float = 1e-6
    agreed: float = 1e-9
    close: float = 1e-4
    definite: float = 1e-2
    wild: float = 1e3
    displaced: float = 1e-6
    back: float = 1e-8
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
    """Estimates from measurements, searches for the best value, and numbers that are given twice.

    Attributes
    ----------
    difference : float
        Relative step of differences while parameters are estimated.
    effect : float
        Least step, of the limits' span, of differences that tell how well they are known.
    estimated, flat : float
        Relative change of parameters and residuals, and the gradient, where the estimate ends.
    independent : float
        Ratio of the smallest to the largest effect of a parameter below which the data do not depend on it.
    accuracy, level : float
        Of a best value, of the search interval; and of the outcome there.
    agreement : float
        Two ways to give one number, or two responses of one motion, may differ by so much of it (printed data are rounded).
    narrow : float
        Least step towards the largest response, of the interval.
    exhausted : float
        Part of the energy that is lost in a period of a decay that has ended.
    endless : float
        Amplitude above which a response has no bound.
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
    """Where floats guide a proof; nothing that is proved rests on these.

    Attributes
    ----------
    near : float
        Distance of nodes that are one: of what is proved and what was computed, of an orbit and its mirror image.
    rounded : float
        Newton corrections below this may stop shrinking: they are rounding.
    short : float
        Clock of a flight whose ends may be merged.
    narrow : float
        Half a tile about a special point from which floats can go on.
    least_tile, graded : float
        A tile's least share of a piece, and the factor by which it may be smaller near special points.
    inside : float
        Part of the way into a piece at which its side of a special point is looked at.
    overlap : float
        Part of a least tile by which the last one goes beyond the end.
    rough : float
        Relative error of a determinant that another arithmetic finds apart from 0, too.
    critical : float
        Multipliers this close to the circle are told from it by exact eigenvectors.
    real : float
        Share of a multiplier's imaginary part that is none.
    mixed, singular : float
        Condition from which on eigenvectors are nearly parallel, and a basis is none.
    largest : float
        Numbers above this leave the range in which their squares are numbers.
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
        Forcing periods: the most that one call follows a motion.
    chatter : float
        Time in which all further impacts of a chatter happen, below which the absorber is put to rest.
    still : float
        Speed after an impact, or time, that is none.
    least_speed : float
        That of an impact which roundoff leaves none.
    leave : float
        Time by which a zero is left behind, at least, when the next one is looked for.
    slip : float
        Phase by which a slip may miss the instant at which friction gives way: the equations solve for it.
    """

    forever: float = 1e7
    chatter: float = 1e-7
    still: float = 1e-13
    least_speed: float = 1e-30
    leave: float = 1e-8
    slip: float = 1e-6


@dataclass(frozen=True)
class Integrating:
    """Error of a step of scipy's integrator (heyoka's goes to rounding by itself), relative and absolute."""

    relative: float = 1e-13
    absolute: float = 1e-14


@dataclass(frozen=True)
class Formulas:
    """What a machine file's formulas, a structure's matrices and polynomials with known roots are held to.

    Attributes
    ----------
    same : float
        Relative difference of numbers that a formula gives in two ways, or of a matrix and its transpose.
    zero : float
        Share of the largest below which an effect, or a natural frequency squared, is none.
    real : float
        Relative imaginary part of a root that is real.
    runaway : float
        Size of a state beyond which it is no fault of a formula that it is no number.
    """

    same: float = 1e-8
    zero: float = 1e-12
    real: float = 1e-9
    runaway: float = 1e8


@dataclass(frozen=True)
class Theory:
    """Of the method of multiple scales.

    Attributes
    ----------
    rounding : float
        Coefficients and squared amplitudes, relative to the largest, that are rounding.
    off_end : float
        Distance (radians, or velocity) from an end of a manifold's piece, where its slope is infinite.
    relative, absolute : float
        Error of a step in integrating the slow flow.
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
