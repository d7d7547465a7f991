"""Protocols of the integrators of declared machines (see `orbits.integrators`); `heyoka` and `solve_ivp` implement them."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Protocol

import numpy as np

Crossing = tuple[float, int, np.ndarray]
"""Clock, index of the function, state."""


class Flight(Protocol):
    """A flow with its derivatives, one flight at a time."""

    def __call__(
        self, state: np.ndarray, begin: float, end: float, numbers: np.ndarray, out: np.ndarray
    ) -> bool: ...


class Flights(Protocol):
    """A flow with its derivatives, several flights at once."""

    def __call__(
        self, states: np.ndarray, begin: np.ndarray, end: np.ndarray, numbers: np.ndarray, out: np.ndarray
    ) -> bool: ...


class Watch(Protocol):
    """A flow that reports every rise of given functions through zero."""

    def __call__(
        self, state: np.ndarray, begin: float, end: float, numbers: np.ndarray
    ) -> Sequence[Crossing]: ...
    def move(self, state: np.ndarray, begin: float, end: float, numbers: np.ndarray) -> None: ...
    def path(self, state: np.ndarray, clocks: np.ndarray, numbers: np.ndarray) -> np.ndarray: ...
    @property
    def final(self) -> np.ndarray: ...


class Run(Protocol):
    """A flow that ends at the first fall of one of its functions through zero."""

    def __call__(
        self, state: np.ndarray, begin: float, end: float, numbers: np.ndarray
    ) -> tuple[float, int | None]: ...
