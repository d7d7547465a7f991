"""The population of a machine, an orbit or a problem; what it offers is in :mod:`contvines.problems.populations`."""

from __future__ import annotations

from typing import Protocol, runtime_checkable

from ..problems.abilities import Populated
from ..problems.populations import Population as Population


@runtime_checkable
class _Orbit(Protocol):
    """A solution that hands out its problem."""

    def problem(self, over: str | None) -> object: ...


def population_of(thing: object, over: str | None = None, **parameters: float) -> Population:
    """The population of a machine, an orbit or a problem; a population is returned as it is.

    Raises
    ------
    ValueError
        If it has none, or no such parameter.
    """
    if isinstance(thing, Population):
        return thing
    if not isinstance(thing, Populated) and isinstance(thing, _Orbit) and callable(thing.problem):
        thing = thing.problem(over)
    if not isinstance(thing, Populated):
        raise ValueError(
            f"{type(thing).__name__} cannot be simulated from many starts: give a machine, one of its orbits, or a map"
        )
    return thing.population(over, **parameters)
