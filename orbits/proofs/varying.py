"""The parameter that varies, and the machine's numbers that move with it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, overload

from orbits.proofs.balls import ball
from orbits.proofs.jets import power

if TYPE_CHECKING:
    from flint import arb

    from orbits.proofs.jets import Jet, Number


@dataclass(frozen=True)
class Varying:
    """A parameter, and what follows it: number j is ``factor * parameter**exponent``.

    Attributes
    ----------
    name : str
        As people call it; for a machine in physical units a quantity, counted in its unit.
    numbers : dict of str to (str, int or float)
        By the machine's number: the factor, an exact decimal, and the exponent.
    """

    name: str
    numbers: Mapping[str, tuple[str, int | float]]

    @overload
    def at(self, value: arb) -> dict[str, arb]: ...
    @overload
    def at(self, value: Jet) -> dict[str, Jet]: ...
    def at(self, value: Number) -> Mapping[str, Number]:
        """The numbers that move, at a value of the parameter (a ball or a jet)."""
        return {
            number: power(value, exponent) if factor == "1" else ball(factor) * power(value, exponent)
            for number, (factor, exponent) in self.numbers.items()
        }
