"""Machines whose sides have numbers of their own, which one name may stand for at once: `restitution` for `restitution_left` and `restitution_right`."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from orbits.machines.base import Model
from orbits.machines.parameters import ParameterError

PAIRS = {name: (f"{name}_left", f"{name}_right") for name in ("restitution", "friction")}
"""Names that stand for both sides at once."""


class Sided(Model):
    """A machine that varies the numbers of both sides together where they are given together."""

    def _check_together(self) -> None:
        for both, sides in PAIRS.items():
            given = [side for side in sides if getattr(self, side) is not None]
            if getattr(self, both) is not None and given:
                raise ParameterError(
                    f"{both} = {getattr(self, both):g} and {given[0]} = {getattr(self, given[0]):g} are both given: give {both} for "
                    f"both sides, or {sides[0]} and {sides[1]}"
                )
            if getattr(self, both) is None and len(given) < 2:
                missing = next(side for side in sides if side not in given)
                raise ParameterError(
                    f"{missing if given else both} is missing: give {both} for both sides, or {sides[0]} and {sides[1]}"
                )

    @property
    def _together(self) -> dict[str, str]:
        """Each side that is given together with the other one, and the name they share."""
        return {
            side: both for both, sides in PAIRS.items() if getattr(self, both) is not None for side in sides
        }

    def vector(self, values: Mapping[str, Any] | None = None) -> np.ndarray:
        given = dict(values or {})
        for both, sides in PAIRS.items():
            shared = given.pop(both, getattr(self, both))
            if shared is not None:
                given = dict.fromkeys(sides, shared) | given
        return super().vector(given)

    @property
    def amount_names(self) -> tuple[str, ...]:
        shared = self._together
        return tuple(dict.fromkeys(shared.get(name, name) for name in self.parameter_names))

    def amounts(self, params: np.ndarray) -> np.ndarray:
        shared, names = self._together, self.amount_names
        places = [names.index(shared.get(name, name)) for name in self.parameter_names]
        return np.array([params[places.index(k)] for k in range(len(names))])

    def path(self, name: str, params: np.ndarray) -> np.ndarray:
        self.place_of(name)
        shared = self._together
        path = np.zeros((2, params.size))
        path[:, [shared.get(other, other) == name for other in self.parameter_names]] = 1.0
        return path

    @property
    def law(self) -> np.ndarray:
        shared, names = self._together, self.amount_names
        if not shared:
            return super().law
        law = np.zeros((len(names) + 1, len(self.parameter_names)))
        law[0] = 1.0
        for j, name in enumerate(self.parameter_names):
            law[names.index(shared.get(name, name)) + 1, j] = 1.0
        return law
