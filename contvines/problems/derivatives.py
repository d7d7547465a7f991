"""A user's equations with their derivatives: given ones, the complex step where the function allows it, else differences."""

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

BESIDE = (-0.37, 0.41)  # lengths aside where noise is there as well


class Differentiated:
    """A callable f(u, p) -> ndarray with its derivatives.

    Parameters
    ----------
    f : callable
        (u of shape (n,), p) -> n numbers.
    jacobian : callable, optional
        (u, p) -> (n, n): an array, a sparse matrix or a LinearOperator.
    derivative : callable, optional
        (u, p) -> (n,), with respect to p; of several parameters a mapping of such callables by name.
    u : ndarray, shape (n,)
        Where f is measured: lengths over which it bends, noise, whether the complex step works.
    parameters : ParameterSet
    name : str
        Of f, for messages.
    sparsity : Colouring, optional
        Where the Jacobian has entries at all.
    start_name, called : str
        What u is called, and with what f is called, for messages.

    Attributes
    ----------
    lengths : ndarray, shape (n,)
        Over which f bends in each unknown; where it does not, the unknown's size, or 1.
    bends : ndarray of bool, shape (n,)
        Where it does.
    known : ndarray of bool, shape (n,)
        Where the length comes from f or from the unknown itself, and is not just 1.
    noise : ndarray, shape (n,)
        Standard deviation of each entry of f beyond roundoff.
    grain : ndarray, shape (n,)
        The same with roundoff.
    errors : ndarray, shape (n,)
        Estimated errors of the columns of the last Jacobian.

    Raises
    ------
    ValueError
        If f, or a given derivative, will not do at u; the sentence says why.
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
        self.words = ""  # of the last failure beside a point
        self.rows = 0  # numbers that f returns, where these are not as many as unknowns
        self._bind()
        p, n = parameters.start, len(u)
        begin = thread_time()
        value = self.checked_value(u, p)
        cost = thread_time() - begin
        if cost > DERIVATIVES.brief:  # the first call may do more than the others
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
        if self.noise.any():  # which may have been taken for bends
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
        """The same callable with other parameters."""
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
        """The same measurements for a similar callable.

        Parameters
        ----------
        f, jacobian, derivative : callables
        name : str, optional
        rows : int
            How many numbers f returns, if not one for each unknown.
        """
        other = copy(self)
        other.f, other.given_jacobian, other.given_derivative = f, jacobian, derivative
        other.name, other.rows = name or self.name, rows
        if rows:
            other.noise = other.grain = np.zeros(rows)
        other._bind()
        return other

    def find_structure(self, u: np.ndarray, preconditioned: bool = False) -> str:
        """ "dense", "sparse" or "operator": what a given Jacobian is at the start; remembered as ``structure``.

        An operator without a preconditioner is "sparse" where it is worth being written out.
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
        """f(u, p), or a ValueError that says what is wrong with it at a start."""
        where = f"at the start {self._where(u, p)}"
        try:
            with np.errstate(all="ignore"):
                given = self._value.raw(u, p)
                value = self._value.flat(given, u, p)
        except NotEvaluable as error:
            raise ValueError(f"{error}, {where}") from error
        shape = given.shape if isinstance(given, Sparse | Operator) else np.shape(given)
        if shape is not None and len(shape) > 1:
            raise ValueError(
                f"{self.name} returns numbers in shape {shape}; they are needed in a row, of shape ({len(u)},)"
            )
        if len(value) != len(u):
            raise ValueError(
                f"{self.name} returns {len(value)} numbers for {len(u)} unknowns; as many are needed"
            )
        if not np.all(np.isfinite(value)):
            raise ValueError(f"{self.name} is not finite {where}")
        return value

    def _where(self, u: np.ndarray, p: float) -> str:
        return f"{self.start_name} = {np.array2string(u, threshold=6)}, {self.parameters.varying} = {p:.10g}"

    def value(self, u: np.ndarray, p: float) -> np.ndarray:
        """f(u, p) as float array."""
        return self._value(u, p)

    def jacobian(self, u: np.ndarray, p: float) -> np.ndarray | csc_array | Operator:
        """df/du, shape (n, n), as an array, or as it was given if that is sparse or a LinearOperator."""
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
        """df/du where it is an array."""
        found = self.jacobian(u, p)
        assert isinstance(found, np.ndarray)
        return found

    def _coloured(self, sparsity: Colouring, u: np.ndarray, p: float) -> csc_array:
        """The sparse Jacobian, with as many differences as there are groups of columns."""
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
        """df/du_j by differences."""

        def shifted(t: float) -> np.ndarray:
            moved = u.copy()
            moved[j] += t
            return self._value(moved, p)

        return self._evaluable(along(self.quietly(shifted), float(self.lengths[j]), self.noise))

    def _evaluable(self, found: Difference) -> Difference:
        if not np.isfinite(found.value).all():
            raise NotEvaluable(self.words or f"{self.name} is not finite beside the point")
        return found

    def derivative(self, u: np.ndarray, p: float) -> np.ndarray:
        """df/dp, shape (n,)."""
        if self.given_slope is not None:
            return self.given_slope(u, p)
        if self.complex_in_parameter(u, p):
            return np.imag(self._value(u.astype(complex), complex(p, COMPLEX_STEP))) / COMPLEX_STEP
        line = self.quietly(lambda t: self._value(u, p + t))
        found = self._evaluable(along(line, self.parameter_length(u, p), self.noise))
        return found.value

    # ------------------------------------------------------------------ what f is like
    def complex_in_parameter(self, u: np.ndarray, p: float) -> bool:
        """Whether the complex step gives the derivative by the parameter that varies, of which f may take the magnitude; tried once for each parameter."""
        name = self.parameters.varying
        if name not in self.complex_parameters:
            self.complex_parameters[name] = self.complex_step and self._complex_step_works(u, p)
        return self.complex_parameters[name]

    def parameter_length(self, u: np.ndarray, p: float) -> float:
        """Length over which f bends in the parameter that varies; measured once for each parameter."""
        name = self.parameters.varying
        if name not in self.parameter_lengths:
            found = bend(self.quietly(lambda t: self._value(u, p + t)), abs(p) or 1.0, noise=self.grain)
            self.parameter_lengths[name] = found or abs(p) or 1.0
        return self.parameter_lengths[name]

    def quietly(self, line: Callable[[Any], np.ndarray]) -> Callable[[Any], np.ndarray]:
        """The function with NaN where it cannot be evaluated."""
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
            if (noise > floor).any():  # that of one place alone, as at the root of |u|, is a singularity
                beside = [noise_of(lambda t, s=s: line(s + t), DERIVATIVES.spacing) for s in BESIDE]
                noise = np.where((noise > floor) & (np.max(beside, axis=0) <= floor), 0.0, noise)
            # between the stairs of a staircase neighbouring samples tell nothing
            steps = roughness(line)
            noise = np.where(
                (noise <= floor) & (steps > floor) & (steps < DERIVATIVES.steep * change), steps, noise
            )
            rough = noise > floor
        if np.isfinite(noise).all() and np.isfinite(change).all():
            self.grain, self.noise = noise, np.where(rough, noise, 0.0)

    def _complex_step_works(self, u: np.ndarray, p: float) -> bool:
        """Whether imaginary parts are derivatives: compared with differences along a direction beside the start."""
        rng = np.random.default_rng(0)
        u = u + DERIVATIVES.aside * self.lengths * rng.standard_normal(len(u))
        direction = self.lengths * rng.standard_normal(len(u))
        slope = 0.7 * self.parameter_length(u, p)
        try:
            with np.errstate(all="ignore"), catch_warnings():
                simplefilter(
                    "ignore"
                )  # what casts complex numbers to real ones warns, and is found out below
                shifted = self._value(u + 1j * COMPLEX_STEP * direction, complex(p, COMPLEX_STEP * slope))
                exact = np.imag(shifted) / COMPLEX_STEP
                near = along(lambda t: self._value(u + t * direction, p + t * slope), 0.5, self.noise)
        except NotEvaluable:
            return False
        if len(exact) != (self.rows or len(u)) or not np.isfinite(exact).all():
            return False
        return agreeing(exact, near)


def agreeing(exact: np.ndarray, near: Difference) -> bool:
    """Whether a derivative by the complex step is the one by differences."""
    rows = np.abs(near.value) + DERIVATIVES.faint * np.abs(near.value).max(initial=0.0)
    return bool(np.all(np.abs(exact - near.value) <= DERIVATIVES.agree * rows + 10.0 * near.error))
