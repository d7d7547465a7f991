"""Switch: a law that changes at a surface, without a jump of the state."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass


@dataclass(frozen=True, eq=False)
class Switch:
    """A surface at which the equations of motion change: stops with springs, backlash, clutches.

    `motion` finds the sign of the surface, +1 or -1, in ``contact.<name>``.

    Parameters
    ----------
    name : str
        Its letters in words are ``name+`` and ``name-``: the sign after the event.
    surface : callable
        ``(state, phase, p)`` -> a number that is zero on the surface.
    """

    name: str
    surface: Callable

    @property
    def letters(self) -> tuple[str, str]:
        """What a word calls the two crossings."""
        return (f"{self.name}+", f"{self.name}-")
