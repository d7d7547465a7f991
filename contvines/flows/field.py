"""Field: a user's right-hand side and its derivatives at many points at once."""

from __future__ import annotations

import contextlib
from collections.abc import Callable, Iterable, Mapping
from copy import copy
from typing import TYPE_CHECKING, NamedTuple, overload

import numpy as np
from scipy.sparse import issparse

from contvines.shared.floating_point import COMPLEX_STEP

from ..problems.derivatives import Differentiated, agreeing
from ..problems.differences import along
from ..problems.functions import NotEvaluable, ParameterSet
from ..problems.large.jacobians import Colouring
from .compiled import CompiledRates
from .events import Events
from .settings import FlowSettings
from .sparse import LARGE, found_sparsity

if TYPE_CHECKING:
    from ..problems.functions import Parameters

STEP = 0.01  # of differences, in lengths over which the right-hand side bends: sixth order, so a hundredfold rounding of it
SIXTH = ((1, 0.75), (2, -0.15), (3, 1.0 / 60.0))


class At(NamedTuple):
    """States (n, d), parameters and times (n,) at which a function is asked."""

    x: np.ndarray
    parameters: Parameters | complex
    t: np.ndarray | None


class Field:
    """x' = f(x, p) or f(x, p, t), at points of shape (n, d) and times of shape (n,).

    Parameters
    ----------
    f : callable
        (x, p) or (x, p, t) -> d numbers.
    jacobian : callable, optional
        df/dx, shape (d, d), of the same arguments.
    derivative : callable, or mapping of str to callable, optional
        df/dp, shape (d,); of several parameters by name.
    start : ndarray, shape (d,)
    values : ParameterSet
    period : callable, optional
        p -> period of f in t; None for autonomous flows.
    settings : FlowSettings, optional

    Raises
    ------
    ValueError
        If f, or a derivative that is given, is wrong at the start.
    """

    def __init__(
        self,
        f: Callable,
        jacobian: Callable | None,
        derivative: Callable | Mapping[str, Callable] | None,
        start: np.ndarray,
        values: ParameterSet,
        period: Callable | None = None,
        settings: FlowSettings | None = None,
    ) -> None:
        self.settings = settings or FlowSettings()
        self.f, self.given_jacobian, self.given_derivative = f, jacobian, derivative
        self.events = Events(None, period is not None, start, values)
        self.values, self.period, self.node = values, period, len(start)
        slope: Callable | Mapping[str, Callable] | None = None
        if isinstance(derivative, Mapping):
            slope = {name: _at_zero(g, period) for name, g in derivative.items()}
        elif derivative is not None:
            slope = _at_zero(derivative, period)
        self.functions = Differentiated(
            _at_zero(f, period),
            None if jacobian is None else _at_zero(jacobian, period),
            slope,
            start,
            values,
            "the right-hand side",
            start_name="x0",
            called="(x, p), or with period= as (x, p, t)"
            if period is None
            else "(x, p, t), as there is period=",
        )
        self.lengths, self.complex_step = self.functions.lengths, self.functions.complex_step
        if not self.complex_step and not self.functions.noise.any():
            self.complex_step = self.functions._complex_step_works(start, values.start)
        self.compiled = f if isinstance(f, CompiledRates) else None
        self.many = self.many_jacobian = False
        self.many_slope: dict[str, bool] = {}  # by the name of the parameter
        self.complex_slopes: dict[str, bool] = {}  # likewise
        self._find_vectorised(start)
        self.sparsity = self._find_sparsity(start) if self.node >= LARGE else None

    def against(self, values: ParameterSet) -> Field:
        """The same field with other values of the parameters."""
        other = copy(self)
        other.values, other.functions = values, self.functions.against(values)
        return other

    @property
    def forced(self) -> bool:
        """Whether f depends on time."""
        return self.period is not None

    @overload
    def length_of_period(self, p: float) -> float: ...
    @overload
    def length_of_period(self, p: complex) -> complex: ...
    def length_of_period(self, p: complex) -> complex:
        """Period of f in time.

        Raises
        ------
        NotEvaluable
            If it is not positive.
        """
        assert self.period is not None
        try:
            period = self.period(self.values.at(p))
        except Exception as error:  # a user's function may fail in any way
            raise NotEvaluable(f"period raises {type(error).__name__}: {error}") from error
        if not 0.0 < np.real(period) < np.inf:
            raise NotEvaluable(f"period = {period!r} must be positive and finite")
        return period

    # ------------------------------------------------------------------ values
    def __call__(self, x: np.ndarray, p: complex, t: np.ndarray | None = None) -> np.ndarray:
        """f at the points, shape (n, d).

        Raises
        ------
        NotEvaluable
            If f fails or does not return d numbers, real ones of real states.
        """
        at = At(x, self.values.at(p), t)
        if self.compiled is not None:
            return self.compiled.at_points(self.compiled.f, *at, (self.node,))
        found = (self._stacked if self.many else self._each)(self.f, at, (self.node,))
        if found.dtype.kind == "c" and x.dtype.kind != "c" and not isinstance(p, complex):
            if np.imag(found).any():
                raise NotEvaluable("the right-hand side returns complex numbers")
            return np.real(found)
        return found

    def _asked(
        self, f: Callable, x: np.ndarray, at: At, t: object, read: Callable[..., np.ndarray]
    ) -> np.ndarray:
        """What a function returns for a state, or for many as columns, as an array."""
        try:
            return read(f(x, at.parameters) if self.period is None else f(x, at.parameters, t))
        except Exception as error:  # a user's function may fail in any way
            raise NotEvaluable(f"the right-hand side raises {type(error).__name__}: {error}") from error

    def _each(self, f: Callable, at: At, shape: tuple[int, ...]) -> np.ndarray:
        """Point by point."""
        times = [None] * len(at.x) if at.t is None else at.t
        found = [self._asked(f, x.copy(), at, t, _full) for x, t in zip(at.x, times, strict=True)]
        for value in found:
            if value.shape != shape:
                raise NotEvaluable(f"the right-hand side has shape {value.shape}; {shape} is needed")
        return np.array(found)

    def _stacked(self, f: Callable, at: At, shape: tuple[int, ...]) -> np.ndarray:
        """All points at once."""
        return self._asked(f, at.x.T.copy(), at, at.t, lambda given: _broadcast(given, len(at.x), shape))

    def _find_vectorised(self, start: np.ndarray) -> None:
        """Whether many points can be handed over at once, tried at points beside the start."""
        noise = np.random.default_rng(5).uniform(-0.1, 0.1, (7, self.node))
        x, p = start + noise * self.lengths, self.values.start
        t = np.linspace(0.05, 0.95, 7) * self.length_of_period(p) if self.forced else None
        at = At(x, self.values.at(p), t)
        with np.errstate(all="ignore"):
            self.many = self._agrees(self.f, at, (self.node,))
            if self.given_jacobian is not None:
                self.many_jacobian = self._agrees(self.given_jacobian, at, (self.node, self.node))

    def _agrees(self, f: Callable, at: At, shape: tuple[int, ...]) -> bool:
        try:
            single = self._each(f, at, shape)
        except NotEvaluable:
            return False  # points beside the start may be outside of where f is defined
        try:
            together = self._stacked(f, at, shape)
        except Exception:  # a function of one point may fail in any way when it is called with many
            return False
        agree = self.settings.agree
        return bool(np.allclose(single, together, rtol=agree, atol=agree * np.abs(single).max(initial=0.0)))

    def _find_sparsity(self, start: np.ndarray) -> Colouring | None:
        """Where df/dx has entries, at places beside the start."""
        noise, p = np.random.default_rng(9).uniform(-0.3, 0.3, (3, self.node)), self.values.start
        t = np.array([0.3 * self.length_of_period(p)]) if self.forced else None
        given, parameters = self.given_jacobian, self.values.at(p)

        def jacobian(x: np.ndarray):
            if given is None:
                return self.jacobian(x[None, :], p, t)[0]
            return given(x, parameters) if t is None else given(x, parameters, t[0])

        try:
            with np.errstate(all="ignore"):
                return found_sparsity(jacobian, start + noise * self.lengths)
        except NotEvaluable:
            return None

    # ------------------------------------------------------------------ derivatives
    def jacobian_entries(self, x: np.ndarray, p: float, t: np.ndarray | None = None) -> np.ndarray:
        """The entries of a sparse df/dx at the points, shape (n, entries): in the order of the sparsity pattern."""
        pattern = self.sparsity
        assert pattern is not None
        if self.given_jacobian is not None:
            parameters, found = self.values.at(p), np.empty((len(x), len(pattern.indices)))
            for i, y in enumerate(x):
                value = self.given_jacobian(y, parameters, *([] if t is None else [t[i]]))
                value = value.tocsr() if issparse(value) else np.asarray(value)
                found[i] = np.asarray(value[pattern.indices, pattern.columns]).reshape(-1)
            return found
        found = np.empty((len(x), len(pattern.indices)))
        for group in range(pattern.count):
            mask = pattern.groups == group
            if self.complex_step:
                total = np.imag(self(x + 1j * COMPLEX_STEP * mask, p, t)) / COMPLEX_STEP
            else:
                along = STEP * self.lengths * mask
                total = _difference(lambda s, along=along: self(x + s * along, p, t)) / STEP
            own = mask[pattern.columns]
            found[:, own] = total[:, pattern.indices[own]]
        if not self.complex_step:
            found /= self.lengths[pattern.columns]
        return found

    def jacobian(self, x: np.ndarray, p: float, t: np.ndarray | None = None) -> np.ndarray:
        """df/dx at the points, shape (n, d, d)."""
        shape, d = (self.node, self.node), self.node
        if self.compiled is not None and self.compiled.dfdx is not None:
            return self.compiled.at_points(self.compiled.dfdx, x, self.values.at(p), t, shape)
        if self.given_jacobian is not None:
            together = self._stacked if self.many_jacobian else self._each
            return together(self.given_jacobian, At(x, self.values.at(p), t), shape)
        if self.complex_step:  # all directions in one call
            moved = x + 1j * COMPLEX_STEP * np.eye(d)[:, None]
            found = (
                np.imag(self(moved.reshape(-1, d), p, None if t is None else np.tile(t, d))) / COMPLEX_STEP
            )
            return np.ascontiguousarray(found.reshape(d, len(x), d).transpose(1, 2, 0))
        result = np.empty((len(x), *shape))
        for j in range(d):
            step = STEP * self.lengths[j]
            unit = np.zeros(d)
            unit[j] = step
            result[:, :, j] = _difference(lambda s, unit=unit: self(x + s * unit, p, t)) / step
        return result

    def carried(
        self, x: np.ndarray, vectors: np.ndarray, p: float, t: np.ndarray | None = None
    ) -> tuple[np.ndarray, np.ndarray]:
        """f at the points, and df/dx times a vector at each, shape (n, d) both: of one call where complex numbers may be asked."""
        if self.complex_step and self.compiled is None and self.given_jacobian is None:
            found = self(x + 1j * COMPLEX_STEP * vectors, p, t)
            return np.real(found), np.imag(found) / COMPLEX_STEP
        return self(x, p, t), np.einsum("nab,nb->na", self.jacobian(x, p, t), vectors)

    def along(self, line: Callable[[complex], np.ndarray], p: float) -> np.ndarray:
        """Derivative of a function of the parameter at p: by the complex step where f and the period allow it, else by differences.

        Whether they do is tried once for each parameter: they may take its magnitude.
        """
        name = self.values.varying
        if self.complex_slopes.get(name, self.complex_step):
            with contextlib.suppress(NotEvaluable):  # what takes real numbers alone
                exact = np.imag(line(complex(p, COMPLEX_STEP))) / COMPLEX_STEP
                if name not in self.complex_slopes:
                    near = along(lambda t: line(p + t), abs(p) or 1.0)
                    self.complex_slopes[name] = agreeing(exact, near)
                if self.complex_slopes[name]:
                    return exact
        step = STEP * (abs(p) or 1.0)
        return _difference(lambda s: line(p + s * step)) / step

    def with_slope(self, x: np.ndarray, p: float) -> tuple[np.ndarray, np.ndarray]:
        """f and df/dp at the points of an autonomous flow, shape (n, d) each."""
        given = self.given_derivative
        if isinstance(given, Mapping):
            given = given.get(self.values.varying)
        tried = self.complex_slopes.get(self.values.varying, False)
        if given is not None or not tried:
            return self(x, p), self.slope(x, p)
        value = self(x, complex(p, COMPLEX_STEP))
        return np.real(value), np.imag(value) / COMPLEX_STEP

    def slope(self, x: np.ndarray, p: float, t: np.ndarray | None = None) -> np.ndarray:
        """df/dp at fixed points and times, shape (n, d)."""
        given = self.given_derivative
        if self.compiled is not None and self.compiled.dfdp is not None:
            names = list(self.values.values)
            shape, parameters = (self.node, len(names)), self.values.at(p)
            found = self.compiled.at_points(self.compiled.dfdp, x, parameters, t, shape)
            return found[:, :, names.index(self.values.varying)]
        if isinstance(given, Mapping):
            given = given.get(self.values.varying)
        if given is None:
            return self.along(lambda q: self(x, q, t), p)
        at, shape = At(x, self.values.at(p), t), (self.node,)
        if self.values.varying not in self.many_slope:
            first = At(x[:7], at.parameters, None if t is None else t[:7])
            self.many_slope[self.values.varying] = self._agrees(given, first, shape)
        return (self._stacked if self.many_slope[self.values.varying] else self._each)(given, at, shape)


def _difference(line: Callable[[float], np.ndarray]) -> np.ndarray:
    """Derivative at 0 by central differences of sixth order with step 1."""
    return sum(weight * (line(float(k)) - line(float(-k))) for k, weight in SIXTH)  # type: ignore[return-value]


def _at_zero(f: Callable, period: Callable | None) -> Callable:
    """A function of (x, p, t) at t = 0."""
    if period is None or not callable(f):
        return f
    return lambda x, p: f(x, p, 0.0)


def _full(given: object) -> np.ndarray:
    return np.asarray(given.toarray()) if issparse(given) else np.array(given)  # type: ignore[union-attr]


def _broadcast(given: Iterable, n: int, shape: tuple[int, ...]) -> np.ndarray:
    """What a function of arrays of n numbers returned, nested as `shape` has it, as array (n, *shape)."""
    if isinstance(given, np.ndarray) and given.dtype != object:
        if given.shape != (*shape, n):
            raise ValueError(f"shape {given.shape}")
        return np.moveaxis(given, -1, 0)
    flat = list(given)
    if len(flat) != shape[0]:
        raise ValueError(f"{len(flat)} entries")
    if len(shape) == 2:
        rows = [_broadcast(row, n, shape[1:]) for row in flat]
        return np.stack(rows, axis=1)
    values = [np.asarray(value) for value in flat]
    result = np.empty((n, len(values)), dtype=np.result_type(*values))
    for j, value in enumerate(values):
        result[:, j] = value
    return result
