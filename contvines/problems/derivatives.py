"""Derivatives of Python callables: complex step where the callable allows it, else sixth-order differences."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from copy import copy
from typing import Any

import numpy as np

from .parameters import ParameterSet
from .registry import address

COMPLEX_STEP = 1e-40
STEP = 6e-3  # roundoff eps/STEP and truncation STEP^6/140 meet near 1e-14
# sixth-order central difference: weights of f(x + k h) - f(x - k h), Fornberg, Math. Comp. 51 (1988) 699, table 1
WEIGHTS = (3.0 / 4.0, -3.0 / 20.0, 1.0 / 60.0)


def along(f: Callable[[float], np.ndarray], scale: float) -> np.ndarray:
    """Derivative at 0 of a function of one real variable, by sixth-order central differences.

    Parameters
    ----------
    f : callable
        t -> ndarray.
    scale : float
        Size of the variable that t shifts; the step is ``STEP`` times it. Where f cannot be evaluated that far away,
        second-order differences with a step of 1e-6 are used.
    """
    h = STEP * scale
    total = sum(w * (f(k * h) - f(-k * h)) for k, w in enumerate(WEIGHTS, start=1))
    derivative = np.asarray(total) / h
    if np.all(np.isfinite(derivative)):
        return derivative
    h = 1e-6 * scale
    return (f(h) - f(-h)) / (2.0 * h)


class Differentiated:
    """A callable f(u, p) -> ndarray with its derivatives.

    Parameters
    ----------
    f : callable
        (u of shape (n,), p) -> n numbers.
    jacobian : callable, optional
        (u, p) -> (n, n).
    derivative : callable, optional
        (u, p) -> (n,), with respect to p; of several parameters a mapping of such callables by name.
    u : ndarray, shape (n,)
        Where the complex step is tried, and compared with differences, before it is trusted.
    parameters : ParameterSet
    """

    def __init__(
        self,
        f: Callable,
        jacobian: Callable | None,
        derivative: Callable | Mapping[str, Callable] | None,
        u: np.ndarray,
        parameters: ParameterSet,
    ) -> None:
        self.f, self.given_jacobian, self.given_derivative = f, jacobian, derivative
        self.parameters = parameters
        p = parameters.start
        self.complex_step = (
            self._complex_step_works(u, p) if jacobian is None or derivative is None else False
        )

    def against(self, parameters: ParameterSet) -> Differentiated:
        """The same callable with other parameters."""
        other = copy(self)
        other.parameters = parameters
        return other

    def value(self, u: np.ndarray, p: float) -> np.ndarray:
        """f(u, p) as float array."""
        return np.asarray(self.f(u, self.parameters.at(p)), dtype=float).reshape(-1)

    def jacobian(self, u: np.ndarray, p: float) -> np.ndarray:
        """df/du, shape (n, n)."""
        n = len(u)
        if self.given_jacobian is not None:
            return np.asarray(self.given_jacobian(u, self.parameters.at(p)), dtype=float).reshape(n, n)
        result = np.empty((n, n))
        for j in range(n):
            direction = np.zeros(n)
            direction[j] = 1.0
            if self.complex_step:
                result[:, j] = self._imaginary(u + 1j * COMPLEX_STEP * direction, p)
            else:
                result[:, j] = along(lambda t, d=direction: self.value(u + t * d, p), 1.0 + abs(u[j]))
        return result

    def derivative(self, u: np.ndarray, p: float) -> np.ndarray:
        """df/dp, shape (n,)."""
        given = self.given_derivative
        if isinstance(given, Mapping):
            given = given.get(self.parameters.varying)
        if given is not None:
            return np.asarray(given(u, self.parameters.at(p)), dtype=float).reshape(-1)
        if self.complex_step:
            return self._imaginary(u.astype(complex), p + 1j * COMPLEX_STEP)
        return along(lambda t: self.value(u, p + t), 1.0 + abs(p))

    def addresses(self, **others: Any) -> tuple[dict[str, Any], bool]:
        """Where the callables can be found again, by name, and whether all of them can."""
        given = {
            "F": self.f,
            "jacobian": self.given_jacobian,
            "derivative": self.given_derivative,
            **others,
        }
        where: dict[str, Any] = {}
        flat: list[tuple[Callable, str | None]] = []
        for key, f in given.items():
            if isinstance(f, Mapping):
                where[key] = {name: address(part) for name, part in f.items()}
                flat += [(part, where[key][name]) for name, part in f.items()]
            elif f is not None and not callable(f):
                where[key] = np.asarray(f).tolist()
            else:
                where[key] = None if f is None else address(f)
                flat += [] if f is None else [(f, where[key])]
        return where, all(found is not None for _, found in flat)

    def _imaginary(self, u: np.ndarray, p: complex) -> np.ndarray:
        return np.imag(np.asarray(self.f(u, self.parameters.at(p))).reshape(-1)) / COMPLEX_STEP

    def _complex_step_works(self, u: np.ndarray, p: float) -> bool:
        rng = np.random.default_rng(0)
        u = u + 1e-3 * rng.standard_normal(len(u))
        direction, slope = rng.standard_normal(len(u)), 0.7
        try:
            with np.errstate(all="ignore"):
                exact = self._imaginary(u + 1j * COMPLEX_STEP * direction, p + 1j * COMPLEX_STEP * slope)
                near = along(lambda t: self.value(u + t * direction, p + t * slope), 0.1)
        except (TypeError, ValueError, AttributeError):
            return False
        return bool(
            np.all(np.isfinite(exact)) and np.all(np.abs(exact - near) <= 1e-6 * (1.0 + np.abs(near).max()))
        )
