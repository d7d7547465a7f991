"""A user's equations with their derivatives: given ones, else by the complex step if the function allows it, else by differences."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from copy import copy
from time import thread_time
from typing import TYPE_CHECKING, Any
from warnings import catch_warnings, simplefilter

import numpy as np

from contvines.shared.numbers import COMPLEX_STEP

from .differences import Difference, along, bend, noise_of, roughness
from .functions import CALLED, NotEvaluable, Operator, ParameterSet, Sparse, UserFunction, as_matrix
from .scales import measured, of_parameter
from .settings import DERIVATIVES

if TYPE_CHECKING:
    from scipy.sparse import csc_array

    from .large.jacobians import Colouring

NOISE_PLACES = (-0.37, 0.41)  # positions, in lengths from the start, where noise is measured a second time


class Differentiated:
    """A callable f(u, p) -> ndarray with its derivatives.

    Parameters
    ----------
    f : callable
        (u of shape (n,), p) -> n numbers.
    jacobian : callable, optional
        (u, p) -> (n, n): an array, a sparse matrix or a LinearOperator.
    derivative : callable, optional
        (u, p) -> (n,), with respect to p; for several parameters a mapping of callables by name.
    u : ndarray, shape (n,)
        Point at which f is examined: lengths over which it is nonlinear, noise, whether the complex step works.
    parameters : ParameterSet
    name : str
        Of f, for messages.
    sparsity : Colouring, optional
        Sparsity pattern of the Jacobian.
    start_name, called : str
        Name of u and description of the arguments of f, for messages.

    Attributes
    ----------
    lengths : ndarray, shape (n,)
        Change of each unknown over which f is nonlinear; where f is linear, the unknown's size, or 1 if that is zero.
    bends : ndarray of bool, shape (n,)
        Whether f is nonlinear in each unknown.
    known : ndarray of bool, shape (n,)
        Whether the length comes from f or from the unknown itself; else it is just 1.
    noise : ndarray, shape (n,)
        Standard deviation of each entry of f; 0 where it is only roundoff.
    grain : ndarray, shape (n,)
        The same, with roundoff.
    errors : ndarray, shape (n,)
        Estimated errors of the columns of the last Jacobian.

    Raises
    ------
    ValueError
        If f, or a given derivative, is unusable at u; the message gives the reason.
    """

    def __init__(
        self,
        f: Callable,
        jacobian: Callable | None,
        derivative: Callable | Mapping[str, Callable] | None,
        u: np.ndarray,
        parameters: ParameterSet,
        name: str = "F",
        sparsity: Colouring | None = None,
        start_name: str = "u0",
        called: str = CALLED,
    ) -> None:
        self.sparsity, self.start_name, self.called = sparsity, start_name, called
        self.f, self.given_jacobian, self.given_derivative = f, jacobian, derivative
        self.parameters, self.name = parameters, name
        self.structure = "dense"
        self.words = ""  # message of the last failure next to a point
        self.rows = 0  # length of f's result if it differs from the number of unknowns, else 0
        self._bind()
        p, n = parameters.start, len(u)
        begin = thread_time()
        value = self.checked_value(u, p)
        cost = thread_time() - begin
        if cost > DERIVATIVES.brief:  # the first call may include compilation or caching
            begin = thread_time()
            value = self.checked_value(u, p)
            cost = min(cost, thread_time() - begin)
        self.noise, self.errors, self.complex_step = np.zeros(n), np.zeros(n), False
        self.exact = np.zeros(n)  # errors of a given Jacobian
        self.grain = np.zeros(n)
        self.parameter_lengths: dict[str, float] = {}
        self.lengths = np.where(u == 0.0, 1.0, np.abs(u))
        self._measure_lengths(u, p, cost, 0.0)
        self._measure_noise(u, p, value)
        if self.noise.any():  # the noise may have been mistaken for nonlinearity
            self._measure_lengths(u, p, cost, self.grain)
        if (jacobian is None or self.given_slope is None) and not self.noise.any():
            self.complex_step = self._complex_step_works(u, p)
        self.complex_parameters = {parameters.varying: self.complex_step}

    def _bind(self) -> None:
        given = self.given_derivative
        if isinstance(given, Mapping):
            given = given.get(self.parameters.varying)
        self._value = UserFunction(self.f, self.name, self.parameters, self.called)
        self.given_matrix, self.given_slope = (
            None if f is None else UserFunction(f, name, self.parameters, self.called)
            for f, name in ((self.given_jacobian, "jacobian"), (given, "derivative"))
        )

    def against(self, parameters: ParameterSet) -> Differentiated:
        """Return the same callable with other parameters."""
        other = copy(self)
        other.parameters = parameters
        other._bind()
        return other

    def of(
        self,
        f: Callable,
        jacobian: Callable | None = None,
        derivative: Callable | Mapping[str, Callable] | None = None,
        name: str | None = None,
        rows: int = 0,
    ) -> Differentiated:
        """Return a similar callable with the lengths and noise of this one.

        Parameters
        ----------
        f, jacobian, derivative : callables
        name : str, optional
        rows : int
            Length of f's result, if it is not one number for each unknown.
        """
        other = copy(self)
        other.f, other.given_jacobian, other.given_derivative = f, jacobian, derivative
        other.name, other.rows = name or self.name, rows
        if rows:
            other.noise = other.grain = np.zeros(rows)
        other._bind()
        return other

    def find_structure(self, u: np.ndarray, preconditioned: bool = False) -> str:
        """Determine the structure of the Jacobian at the start, "dense", "sparse" or "operator", and store it as ``structure``.

        A LinearOperator without a preconditioner counts as "sparse" if writing out its matrix is cheaper than GMRES.
        """
        if self.given_matrix is not None:
            matrix = as_matrix(self.given_matrix.raw(u, self.parameters.start), len(u))
            self.structure = "dense" if isinstance(matrix, np.ndarray) else "sparse"
            if isinstance(matrix, Operator):
                from .large.jacobians import worth_it

                written = not preconditioned and worth_it(matrix, len(u))
                self.structure = "sparse" if written else "operator"
        elif self.sparsity is not None:
            self.structure = "sparse"
        return self.structure

    # ------------------------------------------------------------------ values
    def checked_value(self, u: np.ndarray, p: float) -> np.ndarray:
        """Return f(u, p) at a start.

        Raises
        ------
        ValueError
            If f fails, or its result has a wrong shape or is not finite.
        """
        place = f"at the start {self._place_text(u, p)}"
        try:
            with np.errstate(all="ignore"):
                given = self._value.raw(u, p)
                value = self._value.flat(given, u, p)
        except NotEvaluable as error:
            raise ValueError(f"{error}, {place}") from error
        shape = given.shape if isinstance(given, Sparse | Operator) else np.shape(given)
        if shape is not None and len(shape) > 1:
            raise ValueError(f"{self.name} returns an array of shape {shape}; shape ({len(u)},) is needed")
        if len(value) != len(u):
            raise ValueError(
                f"{self.name} returns {len(value)} numbers for {len(u)} unknowns; as many are needed"
            )
        if not np.all(np.isfinite(value)):
            raise ValueError(f"{self.name} is not finite {place}")
        return value

    def _place_text(self, u: np.ndarray, p: float) -> str:
        return f"{self.start_name} = {np.array2string(u, threshold=6)}, {self.parameters.varying} = {p:.10g}"

    def value(self, u: np.ndarray, p: float) -> np.ndarray:
        """Return f(u, p) as a flat array."""
        return self._value(u, p)

    def jacobian(self, u: np.ndarray, p: float) -> np.ndarray | csc_array | Operator:
        """Return df/du, shape (n, n): an array, or a sparse matrix or LinearOperator if the user gave one."""
        n = len(u)
        if self.given_matrix is not None:
            self.errors = self.exact
            given = as_matrix(self.given_matrix.raw(u, p), n)
            if self.structure == "sparse" and isinstance(given, Operator):
                from .large.jacobians import written_out

                return written_out(given, n)
            return given
        if self.sparsity is not None and not self.rows:
            return self._coloured(self.sparsity, u, p)
        result, worst = np.empty((self.rows or n, n)), np.zeros(n)
        for j in range(n):
            if self.complex_step:
                shifted = u.astype(complex)
                shifted[j] += 1j * COMPLEX_STEP
                result[:, j] = np.imag(self._value(shifted, p)) / COMPLEX_STEP
            else:
                found = self.column(u, p, j)
                result[:, j] = found.value
                worst[j] = found.error.max()
        self.errors = worst
        return result

    def dense_jacobian(self, u: np.ndarray, p: float) -> np.ndarray:
        """Return df/du, which must be an array."""
        found = self.jacobian(u, p)
        assert isinstance(found, np.ndarray)
        return found

    def _coloured(self, sparsity: Colouring, u: np.ndarray, p: float) -> csc_array:
        """Return the sparse Jacobian by one difference for each group of columns."""
        n = len(u)
        worst = np.zeros(n)

        def along_columns(mask: np.ndarray) -> np.ndarray:
            if self.complex_step:
                return np.imag(self._value(u + 1j * COMPLEX_STEP * mask, p)) / COMPLEX_STEP
            direction = np.where(mask, self.lengths, 0.0)
            line = self.quietly(lambda t: self._value(u + t * direction, p))
            found = self._evaluable(along(line, 1.0, self.noise))
            worst[mask] = found.error.max()
            return found.value

        matrix = sparsity.jacobian(along_columns)
        if not self.complex_step:
            matrix.data /= self.lengths[sparsity.columns]
            worst /= self.lengths
        self.errors = worst
        return matrix

    def column(self, u: np.ndarray, p: float, j: int) -> Difference:
        """Return df/du_j by differences."""

        def shifted(t: float) -> np.ndarray:
            shifted = u.copy()
            shifted[j] += t
            return self._value(shifted, p)

        return self._evaluable(along(self.quietly(shifted), float(self.lengths[j]), self.noise))

    def _evaluable(self, found: Difference) -> Difference:
        if not np.isfinite(found.value).all():
            raise NotEvaluable(self.words or f"{self.name} is not finite beside the point")
        return found

    def derivative(self, u: np.ndarray, p: float) -> np.ndarray:
        """Return df/dp, shape (n,)."""
        if self.given_slope is not None:
            return self.given_slope(u, p)
        if self.complex_in_parameter(u, p):
            return np.imag(self._value(u.astype(complex), complex(p, COMPLEX_STEP))) / COMPLEX_STEP
        line = self.quietly(lambda t: self._value(u, p + t))
        found = self._evaluable(along(line, self.parameter_length(u, p), self.noise))
        return found.value

    # ------------------------------------------------------------------ lengths, noise, complex step
    def complex_in_parameter(self, u: np.ndarray, p: float) -> bool:
        """Whether the complex step works for the varying parameter (not if f contains its magnitude); tested once for each parameter."""
        name = self.parameters.varying
        if name not in self.complex_parameters:
            self.complex_parameters[name] = self.complex_step and self._complex_step_works(u, p)
        return self.complex_parameters[name]

    def parameter_length(self, u: np.ndarray, p: float) -> float:
        """Change of the varying parameter over which f is nonlinear; measured once for each parameter."""
        name = self.parameters.varying
        if name not in self.parameter_lengths:
            found = bend(self.quietly(lambda t: self._value(u, p + t)), abs(p) or 1.0, noise=self.grain)
            self.parameter_lengths[name] = found or abs(p) or 1.0
        return self.parameter_lengths[name]

    def quietly(self, line: Callable[[Any], np.ndarray]) -> Callable[[Any], np.ndarray]:
        """Return the function with results NaN where it raises NotEvaluable."""
        n = len(self.noise)

        def value(t: float | np.ndarray) -> np.ndarray:
            try:
                found = line(t)
            except NotEvaluable as error:
                self.words = str(error)
                return np.full(n, np.nan)
            if len(found) == n:
                return found
            self.words = f"{self.name} returns {len(found)} numbers there; {n} are needed"
            return np.full(n, np.nan)

        return value

    def _measure_lengths(self, u: np.ndarray, p: float, cost: float, grain: float | np.ndarray) -> None:
        values = self.quietly(lambda v: self._value(v, p))
        terms = of_parameter(self.quietly(lambda q: self._value(u, q)), p)
        self.lengths, self.bends, self.known = measured(values, u, grain, cost, terms)

    def _measure_noise(self, u: np.ndarray, p: float, value: np.ndarray) -> None:
        direction = self.lengths * np.random.default_rng(1).uniform(0.5, 1.0, len(u))
        line = self.quietly(lambda t: self._value(u + t * direction, p))
        with np.errstate(all="ignore"):
            noise = noise_of(line, DERIVATIVES.spacing)
            change = np.max([np.abs(value), *(np.abs(line(t) - value) for t in (-0.7, 0.3, 1.0))], axis=0)
            floor = DERIVATIVES.rounded * np.maximum(change, 0.001 * change.max(initial=0.0))
            # if only this point has it, it is a singularity, such as that of |u| at 0
            if (noise > floor).any():
                nearby = [noise_of(lambda t, s=s: line(s + t), DERIVATIVES.spacing) for s in NOISE_PLACES]
                noise = np.where((noise > floor) & (np.max(nearby, axis=0) <= floor), 0.0, noise)
            # a staircase: close samples lie on the same stair, so that only wide ones show the steps
            steps = roughness(line)
            noise = np.where(
                (noise <= floor) & (steps > floor) & (steps < DERIVATIVES.steep * change), steps, noise
            )
            rough = noise > floor
        if np.isfinite(noise).all() and np.isfinite(change).all():
            self.grain, self.noise = noise, np.where(rough, noise, 0.0)

    def _complex_step_works(self, u: np.ndarray, p: float) -> bool:
        """Whether the complex step works: compare it with differences along a random direction next to the start."""
        rng = np.random.default_rng(0)
        u = u + DERIVATIVES.tested_at * self.lengths * rng.standard_normal(len(u))
        direction = self.lengths * rng.standard_normal(len(u))
        slope = 0.7 * self.parameter_length(u, p)
        try:
            with np.errstate(all="ignore"), catch_warnings():
                simplefilter(
                    "ignore"
                )  # numpy warns when f casts complex numbers to real ones; the comparison detects that
                shifted = self._value(u + 1j * COMPLEX_STEP * direction, complex(p, COMPLEX_STEP * slope))
                exact = np.imag(shifted) / COMPLEX_STEP
                near = along(lambda t: self._value(u + t * direction, p + t * slope), 0.5, self.noise)
        except NotEvaluable:
            return False
        if len(exact) != (self.rows or len(u)) or not np.isfinite(exact).all():
            return False
        return agreeing(exact, near)


def agreeing(exact: np.ndarray, near: Difference) -> bool:
    """Whether a derivative by the complex step agrees with one by differences."""
    rows = np.abs(near.value) + DERIVATIVES.faint * np.abs(near.value).max(initial=0.0)
    return bool(np.all(np.abs(exact - near.value) <= DERIVATIVES.agree * rows + 10.0 * near.error))
