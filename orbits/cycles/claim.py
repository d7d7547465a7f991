"""What is read off an orbit that is claimed to solve its equations, whichever machine's they are: how well, how stable, whether real."""

from __future__ import annotations

import copy
from functools import cached_property
from typing import TYPE_CHECKING, Self

import numpy as np

from orbits.words.margins import limits_of

REAL = (
    -1e-12
)  # margins down to this, in units of the machine's own size, are rounding: a border orbit itself is real


class Claim:
    """Residual, multipliers and margins of an orbit, from one look at its equations."""

    if TYPE_CHECKING:

        def measures(self, *wanted: str) -> dict[str, float]: ...

    @cached_property
    def _examined(self) -> tuple[float, np.ndarray, np.ndarray]:
        """Residual, multipliers of the period and margins."""
        raise TypeError(f"{type(self).__name__} has no equations")

    @property
    def residual(self) -> float:
        """Largest residual of the equations."""
        return self._examined[0]

    @property
    def multipliers(self) -> np.ndarray:
        """Multipliers of the period, complex, largest modulus first; none of them is trivial."""
        return self._examined[1]

    def with_multipliers(self, multipliers: np.ndarray) -> Self:
        """The same orbit, with multipliers that are known otherwise: at a border, one-sided limits.

        Where something has no length or speed at all the equations' own derivatives are rounding.
        """
        residual, _, margins = self._examined
        found = copy.copy(self)
        vars(found)["_examined"] = (residual, limits_of(multipliers), margins)
        return found

    @property
    def margin(self) -> float:
        """The smallest margin, in units of the machine's own size."""
        return float(np.min(self._examined[2]))

    @property
    def real(self) -> bool:
        """Whether a machine can follow the orbit: no margin is negative. At a border one is zero, to rounding, and the orbit real."""
        return self.margin >= REAL

    @property
    def stable(self) -> bool:
        """Whether all multipliers lie inside the unit circle."""
        return bool(np.all(np.abs(self.multipliers) < 1.0))

    def measure(self, name: str) -> float:
        """One measure of the orbit; names: `problem().measure_names`."""
        return float(self.measures(name)[name])
