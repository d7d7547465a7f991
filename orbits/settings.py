"""Tolerances of the machines and of their motions, in groups by what they decide.

Nobody has to set them: they follow from double precision and from lengths and speeds in a machine's own units, in which all of them are
counted. What users choose are the settings of a continuation (`contvines.Settings`). Facts of floating point: `orbits.numbers`; limits of
parameters: the machines' tables.
"""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Solving:
    """When Newton's method has arrived at a motion.

    Attributes
    ----------
    residual : float
        Largest residual of a solution.
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
    """

    residual: float = 1e-10
    last_step: float = 1e-12
    near: float = 1e-9
    rounding: float = 1e-14
    free_step: float = 1e-7
    longest_flight: float = 1e3
    shift: float = 1e-6


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


SOLVING = Solving()
EVENTS = Events()
GROWING = Growing()
