"""DryFriction: Coulomb's law, with the force at rest that the motion asks for."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

SLIDE_BACK, STUCK, SLIDE_ON, ABSENT = -1, 0, 1, 2  # modes; ABSENT: the limit is zero


@dataclass(frozen=True, eq=False)
class DryFriction:
    """Dry friction between two bodies, or a body and the ground.

    While they slide the force is ``-limit sign(velocity)``; while they stick it is the one that keeps the velocity at zero,
    until that would have to exceed the limit. `motion` finds the force in ``contact.<name>``.

    Parameters
    ----------
    name : str
    velocity : callable
        ``(state, phase, p)`` -> relative velocity.
    limit : str, float or callable
        Largest force: the name of a parameter, a number, or a function of ``(state, phase, p)`` (the normal force may vary,
        and so may the coefficient with the velocity).
    letters : sequence of three str
        For a turn (the velocity changes its sign at once), a stick and a slip.
    """

    name: str
    velocity: Callable
    limit: float | str | Callable
    letters: Sequence[str] = ("t", "s", "u")
