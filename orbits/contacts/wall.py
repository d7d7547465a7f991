"""Wall: a stop that bodies hit."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

FREE, HELD = 0, 1  # modes


@dataclass(frozen=True, eq=False)
class Wall:
    """A unilateral contact with Newton's impact law.

    The gap stays at or above zero. At an impact an impulse acts along `push`, as large as turns the gap's rate into
    -restitution times itself. Where infinitely many impacts pile up, or the restitution leaves no speed, the wall then
    holds the bodies together for as long as it has to push.

    Parameters
    ----------
    letter : str
        Its letter in words, for example "R".
    gap : callable
        ``(state, phase, p)`` -> the distance, 0 at contact.
    push : mapping
        State's name -> how a unit impulse changes it: a number, the name of a parameter, or a function of
        ``(state, phase, p)``. Only rates of positions may be pushed: an impulse does not move the gap itself.
    restitution : str or float
        Newton's coefficient, or the name of a parameter; above 0 and at most 1.
    """

    letter: str
    gap: Callable
    push: Mapping[str, float | str | Callable]
    restitution: float | str = 1.0

    @property
    def name(self) -> str:
        """The wall's letter."""
        return self.letter

    @property
    def letters(self) -> tuple[str, ...]:
        """The one letter of its impacts."""
        return (self.letter,)
