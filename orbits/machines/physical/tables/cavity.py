"""The quantities of a cavity with unlike walls in SI units: those of the shaken cavity, each side's own, and the slope.

`restitution` and `friction` are those of both sides; the sides' own names tell them apart. Distances of the walls are counted in half-widths,
so that the half-width scales the whole cavity.
"""

from __future__ import annotations

from orbits.machines.physical.quantities import Quantity, QuantityError
from orbits.machines.physical.tables import limits
from orbits.machines.physical.tables.shaken import GAUGES as GAUGES
from orbits.machines.physical.tables.shaken import QUANTITIES as SHAKEN
from orbits.machines.physical.tables.shaken import SCALES as SCALES
from orbits.machines.physical.tables.shaken import completed as completed_shaken

_SIDES = {"restitution": limits.RESTITUTION, "friction": limits.FRICTION}


def _of_sides(name: str, example: str, usual: tuple[float, float], zero: bool) -> tuple[Quantity, ...]:
    """One for both sides and how much larger it is on the right, or one for each side."""
    left, right = f"{name}_left", f"{name}_right"
    ratio = f"{right}_over_left"
    return (
        Quantity(name, "", example, {left: 1}, usual, f"a coefficient of {name}", group=left, zero=zero),
        Quantity(left, "", example, {left: 1}, usual, f"a coefficient of {name}", group=left, zero=zero),
        Quantity(ratio, "", "1", {right: 1, left: -1}, limits.RATIO, f"the ratio of the sides' {name}", group=right, default=1.0),
        Quantity(right, "", example, {right: 1}, usual, f"a coefficient of {name}", group=right, zero=zero),
    )  # fmt: skip


QUANTITIES = {
    **{name: quantity for name, quantity in SHAKEN.items() if name not in _SIDES},
    **{
        quantity.name: quantity
        for quantity in (
            *_of_sides("restitution", "0.6", _SIDES["restitution"], False),
            *_of_sides("friction", "0.1", _SIDES["friction"], True),
            Quantity("slope", "rad", "5 deg", {"slope": 1}, (-1.6, 1.6), "the cavity's angle", zero=True, signed=True, default="0 deg"),
            Quantity("distance_left", "", "1", {"distance_left": 1}, limits.RATIO, "the left wall's distance in half-widths", default=1.0),
            Quantity("distance_right", "", "1", {"distance_right": 1}, limits.RATIO, "the right wall's distance in half-widths", default=1.0),
        )
    },
}  # fmt: skip


def completed(given: dict[str, float]) -> dict[str, float]:
    """The quantities [SI] with what follows from them.

    Raises
    ------
    QuantityError
        If a quantity is given for both sides and for one of them, or for one side only.
    """
    for name in _SIDES:
        left, right, ratio = f"{name}_left", f"{name}_right", f"{name}_right_over_left"
        if name in given and right in given:
            raise QuantityError(
                f"{name} and {right} are both given: give {name} for both sides, or {left} and {right}"
            )
        if (left in given) != (right in given) and ratio not in given:
            missing = right if left in given else left
            raise QuantityError(f"{missing} is missing: give {name} for both sides, or {left} and {right}")
    return completed_shaken(given)
