"""What a survey asks of a family of systems: something to begin a diagram with, and, where a family has them, simulations."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any, Protocol, runtime_checkable

Family = Callable[[Mapping[str, float], Any], object]
"""(values, near) -> the system with these values and a solution of it to begin with; `near` is what `Carrying.starts` had of it, or None."""
Simulated = tuple[float, Mapping[str, float], str]
"""A motion on which a simulation settles: value of the parameter, measures by name, word."""


@runtime_checkable
class Carrying(Protocol):
    """A family whose solutions begin with those of neighbours: one entry for each system, None where it begins by itself."""

    def starts(
        self, systems: Sequence[Mapping[str, float]], neighbours: Sequence[int | None]
    ) -> Sequence[object]: ...


@runtime_checkable
class Simulating(Protocol):
    """A family that simulates a system, from so many starts at each of some values of the parameter `over`."""

    def simulated(
        self, values: Mapping[str, float], over: str, at: Sequence[float], starts: int
    ) -> Sequence[Simulated]: ...


@runtime_checkable
class Sweeping(Protocol):
    """A family that tells the responses of a system by simulation alone: values of the parameter `over`, and a measure there."""

    def swept(
        self, values: Mapping[str, float], over: str, at: Sequence[float]
    ) -> Sequence[tuple[float, float]]: ...
