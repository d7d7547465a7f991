"""What the equations of all flows have in common: a machine's numbers, which follow one parameter."""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING, Generic, TypeVar

import numpy as np

from orbits.machines.path import along

if TYPE_CHECKING:
    from orbits.machines.varying import Varying

ModelOf = TypeVar("ModelOf", bound="Varying")


class Against(Generic[ModelOf]):
    """Equations against a parameter of a machine; see `orbits.flows.protocol.Equations`."""

    model: ModelOf
    parameter: str
    params: np.ndarray
    path: np.ndarray
    twist: float

    def values(self, p: float | np.ndarray) -> np.ndarray:
        """The parameter vector at parameter value `p`, shape (P,); (m, P) for an array of values."""
        return along(self.path, self.params, p)

    def value(self, params: np.ndarray) -> float:
        """The value of the parameter that varies in a parameter vector."""
        return self.model.amount(self.parameter, params)

    @property
    def began(self) -> float:
        """The value of the parameter that varies in the parameter vector."""
        return self._began

    @cached_property
    def _began(self) -> float:
        return self.value(self.params)

    def to_multipliers(self, spectrum: np.ndarray) -> np.ndarray:
        """Multipliers of the full period from those of the closure map (half maps: squared)."""
        spectrum = np.asarray(spectrum, dtype=complex)
        return spectrum**2 if self.twist < 0.0 else spectrum
