"""Field: a user's right-hand side and its derivatives at many points at once; Events: functions whose zeros stop motions."""

from __future__ import annotations

import contextlib
from collections.abc import Callable, Mapping, Sequence
from copy import copy
from typing import TYPE_CHECKING, Any, overload

import numpy as np
from scipy.sparse import issparse

from contvines.shared.numbers import COMPLEX_STEP, ROUNDED

from ..problems.derivatives import Differentiated, agreeing
from ..problems.differences import along
from ..problems.functions import NotEvaluable, ParameterSet
from ..problems.large.jacobians import Colouring
from .at_points import TRIED, AtPoints, CompiledRates
from .settings import FlowSettings
from .sparse import LARGE, found_sparsity

if TYPE_CHECKING:
    from ..problems.functions import Parameters

STEP = 0.01  # of sixth-order differences, in lengths over which the right-hand side is nonlinear; the error is a hundred times its rounding
SIXTH = ((1, 0.75), (2, -0.15), (3, 1.0 / 60.0))  # weights of f(x + k h) - f(x - k h)
SWEEPS = 30  # most steps of Newton's method for an equilibrium
RANK = 8.0 * ROUNDED  # singular values below this part of the largest one count as zero
FINER = 4  # places between two nodes at which an event is evaluated first, to find its smallest value
ROUNDS = 3  # refinements of that search, ...
CLOSER = 16  # ... each on so many parts of the remaining interval


class Field:
    """The right-hand side of x' = f(x, p) or f(x, p, t), evaluated at points of shape (n, d) and times of shape (n,).

    Parameters
    ----------
    f : callable
        (x, p) or (x, p, t) -> d numbers.
    jacobian : callable, optional
        df/dx, shape (d, d), of the same arguments.
    derivative : callable, or mapping of str to callable, optional
        df/dp, shape (d,); a mapping by name for several parameters.
    events : mapping of str to callable, optional
        See :class:`Events`.
    start : ndarray, shape (d,)
    values : ParameterSet
    period : callable, optional
        p -> period of f in t; None for autonomous flows.
    settings : FlowSettings

    Raises
    ------
    ValueError
        If f, an event, or a given derivative is unusable at the start.
    """

    def __init__(
        self,
        f: Callable,
        jacobian: Callable | None,
        derivative: Callable | Mapping[str, Callable] | None,
        events: Mapping[str, Callable] | None,
        start: np.ndarray,
        values: ParameterSet,
        period: Callable | None,
        settings: FlowSettings,
    ) -> None:
        self.f, self.given_derivative = f, derivative
        self.values, self.period, self.node, self.settings = values, period, len(start), settings
        self.forced = period is not None
        slopes = derivative
        if isinstance(derivative, Mapping):
            slopes = {name: self._at_zero(g) for name, g in derivative.items()}
        elif derivative is not None:
            slopes = self._at_zero(derivative)
        measured = Differentiated(
            self._at_zero(f),
            None if jacobian is None else self._at_zero(jacobian),
            slopes,
            start,
            values,
            "the right-hand side",
            start_name="x0",
            called="(x, p, t), as there is period="
            if self.forced
            else "(x, p), or with period= as (x, p, t)",
        )
        self.lengths, self.complex_step = measured.lengths, measured.complex_step
        if not self.complex_step and not measured.noise.any():
            self.complex_step = measured._complex_step_works(start, values.start)
        self.compiled = f if isinstance(f, CompiledRates) else None
        d = self.node
        self._rates = AtPoints(f, self.forced, (d,))
        self._matrices = None if jacobian is None else AtPoints(jacobian, self.forced, (d, d))
        self._slopes: dict[str, AtPoints] = {}  # given df/dp by the name of the parameter
        self.complex_slopes: dict[str, bool] = {}  # by parameter: whether the complex step works for it
        x = start + np.random.default_rng(5).uniform(-0.1, 0.1, (TRIED, d)) * self.lengths
        t = np.linspace(0.05, 0.95, TRIED) * self.length_of_period(values.start) if self.forced else None
        with np.errstate(all="ignore"):
            for function in (self._rates, self._matrices):
                if function is not None:
                    function.find(settings.agree, x, values.at(values.start), t)
        self.sparsity = self._find_sparsity(start) if d >= LARGE else None
        self.events = Events(events, self.forced, start, values, settings.agree)

    def _at_zero(self, f: Callable) -> Callable:
        """Fix t = 0 in a function of (x, p, t)."""
        return (lambda x, p: f(x, p, 0.0)) if self.forced and callable(f) else f

    def against(self, values: ParameterSet) -> Field:
        """Return the same field with other values of the parameters."""
        other = copy(self)
        other.values = values
        return other

    @overload
    def length_of_period(self, p: float) -> float: ...
    @overload
    def length_of_period(self, p: complex) -> complex: ...
    def length_of_period(self, p: complex) -> complex:
        """Return the period of f in time.

        Raises
        ------
        NotEvaluable
            If it is not positive and finite.
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
        """Return f at the points, shape (n, d).

        Raises
        ------
        NotEvaluable
            If f fails, does not return d numbers, or returns complex numbers for real arguments.
        """
        found = self._evaluated(self._rates, x, p, t)
        if found.dtype.kind == "c" and x.dtype.kind != "c" and not isinstance(p, complex):
            if np.imag(found).any():
                raise NotEvaluable("the right-hand side returns complex numbers")
            return np.real(found)
        return found

    def _evaluated(self, function: AtPoints, x: np.ndarray, p: complex, t: np.ndarray | None) -> np.ndarray:
        try:
            return function(x, self.values.at(p), t)
        except NotEvaluable:
            raise
        except Exception as error:  # a user's function may fail in any way
            raise NotEvaluable(f"the right-hand side raises {type(error).__name__}: {error}") from error

    def rate_at(self, p: float) -> Callable[[float, np.ndarray], np.ndarray]:
        """Return the function (t, x) -> x' for scipy's integrators; NaN where f fails."""
        f, parameters, forced = self.f, self.values.at(p), self.forced

        def rate(t: float, x: np.ndarray) -> np.ndarray:
            try:
                value = np.asarray(f(x, parameters, t) if forced else f(x, parameters)).reshape(len(x))
                if value.dtype.kind == "c":
                    value = np.where(np.imag(value) == 0.0, np.real(value), np.nan)
                return value.astype(float)
            except Exception:  # a user's function may fail in any way
                return np.full(len(x), np.nan)

        return rate

    # ------------------------------------------------------------------ derivatives
    def _find_sparsity(self, start: np.ndarray) -> Colouring | None:
        """Sparsity pattern of df/dx, from its entries at random points next to the start; None if it is dense."""
        noise, p = np.random.default_rng(9).uniform(-0.3, 0.3, (3, self.node)), self.values.start
        t = np.array([0.3 * self.length_of_period(p)]) if self.forced else None
        given, parameters = self._matrices, self.values.at(p)

        def jacobian(x: np.ndarray) -> Any:
            if given is None:
                return self.jacobian(x[None, :], p, t)[0]
            return given._call(x, parameters, None if t is None else t[0])

        try:
            with np.errstate(all="ignore"):
                return found_sparsity(jacobian, start + noise * self.lengths)
        except NotEvaluable:
            return None

    def _column_sums(self, masks: np.ndarray, x: np.ndarray, p: float, t: np.ndarray | None) -> np.ndarray:
        """Sums of columns of df/dx at the points, shape (k, n, d), for k masks of columns: by the complex step, or by differences in units of the lengths."""
        if self.complex_step:
            shifted = (x + 1j * COMPLEX_STEP * masks[:, None]).reshape(-1, self.node)
            times = None if t is None else np.tile(t, len(masks))
            return np.imag(self(shifted, p, times)).reshape(len(masks), *x.shape) / COMPLEX_STEP
        steps = STEP * self.lengths * masks
        return np.array([_difference(lambda s, h=h: self(x + s * h, p, t)) / STEP for h in steps])

    def jacobian_entries(self, x: np.ndarray, p: float, t: np.ndarray | None = None) -> np.ndarray:
        """Return the entries of a sparse df/dx at the points, shape (n, entries), in the order of the sparsity pattern."""
        pattern, given = self.sparsity, self._matrices
        assert pattern is not None
        found = np.empty((len(x), len(pattern.indices)))
        if given is not None:
            parameters = self.values.at(p)
            for i, y in enumerate(x):
                value = given._call(y, parameters, None if t is None else t[i])
                value = value.tocsr() if issparse(value) else np.asarray(value)  # type: ignore[attr-defined]
                found[i] = np.asarray(value[pattern.indices, pattern.columns]).reshape(-1)
            return found
        for group in range(pattern.count):
            mask = pattern.groups == group
            chosen = mask[pattern.columns]
            found[:, chosen] = self._column_sums(mask[None], x, p, t)[0][:, pattern.indices[chosen]]
        return found if self.complex_step else found / self.lengths[pattern.columns]

    def jacobian(self, x: np.ndarray, p: float, t: np.ndarray | None = None) -> np.ndarray:
        """Return df/dx at the points, shape (n, d, d)."""
        if self._matrices is not None:
            return self._evaluated(self._matrices, x, p, t)
        found = np.ascontiguousarray(self._column_sums(np.eye(self.node), x, p, t).transpose(1, 2, 0))
        return found if self.complex_step else found / self.lengths

    def rest(
        self, x: np.ndarray, p: float, sizes: np.ndarray, tolerance: float, far: float = np.inf
    ) -> np.ndarray | None:
        """Return the equilibrium to which Newton's method converges from a state; None if it fails or moves farther than `far` sizes.

        Parameters
        ----------
        x, sizes : ndarray, shape (d,)
            Start, and typical sizes of the states.
        p : float
        tolerance : float
            Largest last correction, in sizes.
        """
        start = x
        for _ in range(SWEEPS):
            with np.errstate(all="ignore"):
                try:
                    rate, matrix = self(x[None], p)[0], self.jacobian(x[None], p)[0]
                except (ValueError, NotEvaluable):
                    return None
            if not (np.isfinite(rate).all() and np.isfinite(matrix).all()):
                return None
            step = np.linalg.lstsq(matrix * sizes, -rate, rcond=RANK)[0] * sizes
            x = x + step
            if not (np.abs(x - start) <= far * sizes).all():
                return None
            if (np.abs(step) <= tolerance * sizes).all():
                return x
        return None

    def carried(
        self, x: np.ndarray, vectors: np.ndarray, p: float, t: np.ndarray | None = None
    ) -> tuple[np.ndarray, np.ndarray]:
        """Return f and df/dx times a vector at each point, shape (n, d) both; one call of f is enough if the complex step works."""
        if self.complex_step and self._matrices is None:
            found = self(x + 1j * COMPLEX_STEP * vectors, p, t)
            return np.real(found), np.imag(found) / COMPLEX_STEP
        return self(x, p, t), np.einsum("nab,nb->na", self.jacobian(x, p, t), vectors)

    def along(self, line: Callable[[complex], np.ndarray], p: float) -> np.ndarray:
        """Return the derivative of a function of the parameter at p: by the complex step if f and the period allow it, else by differences.

        This is tested once for each parameter: f or the period may contain its magnitude, for example.
        """
        name = self.values.varying
        if self.complex_slopes.get(name, self.complex_step):
            with contextlib.suppress(NotEvaluable):  # f or the period may accept real numbers only
                exact = np.imag(line(complex(p, COMPLEX_STEP))) / COMPLEX_STEP
                if name not in self.complex_slopes:
                    near = along(lambda t: line(p + t), abs(p) or 1.0)
                    self.complex_slopes[name] = agreeing(exact, near)
                if self.complex_slopes[name]:
                    return exact
        step = STEP * (abs(p) or 1.0)
        return _difference(lambda s: line(p + s * step)) / step

    def _given_slope(self) -> Callable | None:
        given = self.given_derivative
        return given.get(self.values.varying) if isinstance(given, Mapping) else given

    def with_slope(self, x: np.ndarray, p: float) -> tuple[np.ndarray, np.ndarray]:
        """Return f and df/dp at points of an autonomous flow, shape (n, d) each."""
        if self._given_slope() is not None or not self.complex_slopes.get(self.values.varying, False):
            return self(x, p), self.slope(x, p)
        value = self(x, complex(p, COMPLEX_STEP))
        return np.real(value), np.imag(value) / COMPLEX_STEP

    def slope(self, x: np.ndarray, p: float, t: np.ndarray | None = None) -> np.ndarray:
        """Return df/dp at points and times, shape (n, d)."""
        given, name = self._given_slope(), self.values.varying
        if given is None:
            return self.along(lambda q: self(x, q, t), p)
        if name not in self._slopes:
            self._slopes[name] = AtPoints(given, self.forced, (self.node,))
        self._slopes[name].find(self.settings.agree, x, self.values.at(p), t)
        return self._evaluated(self._slopes[name], x, p, t)


def _difference(line: Callable[[float], np.ndarray]) -> np.ndarray:
    """Derivative at 0 by central differences of sixth order with step 1."""
    return sum(weight * (line(float(k)) - line(float(-k))) for k, weight in SIXTH)  # type: ignore[return-value]


class Events:
    """Event functions (x, p), or (x, p, t) of forced flows: a motion stops where one vanishes. Each has the sign that it has at the flow's start.

    Parameters
    ----------
    given : mapping of str to callable, or None
    forced : bool
    start : ndarray, shape (d,)
    values : ParameterSet
    agree : float
        Largest relative difference between values of one call and of single calls, see :class:`AtPoints`.

    Raises
    ------
    ValueError
        If a name or a function is unusable, or a function is zero or not finite at the start.
    """

    def __init__(
        self,
        given: Mapping[str, Callable] | None,
        forced: bool,
        start: np.ndarray,
        values: ParameterSet,
        agree: float,
    ) -> None:
        if given is not None and not isinstance(given, Mapping):
            raise ValueError(
                f"events = {given!r} must be functions by name, for example events={{'wall': lambda x, p: 1 - x[0]}}"
            )
        self.given: dict[str, Callable] = dict(given or {})
        self.forced, self.agree, self.names = forced, agree, tuple(self.given)
        arguments = "(x, p, t)" if forced else "(x, p)"
        for name, function in self.given.items():
            if not (isinstance(name, str) and callable(function)):
                raise ValueError(f"events: {name!r} must be a name with a function {arguments} -> number")
        self.functions = [AtPoints(function, forced, ()) for function in self.given.values()]
        self.signs = np.ones(len(self.given))
        try:
            first = self(start[None], values.at(values.start), np.zeros(1))[0]
        except NotEvaluable as error:
            raise ValueError(f"events: {error}") from error
        for name, value in zip(self.names, first, strict=True):
            if not np.isfinite(value) or value == 0.0:
                raise ValueError(
                    f"events: {name} is {value:g} at x0; its sign at x0 determines the side of the motions, so it must be finite and not zero there: choose another x0"
                )
        self.signs = np.sign(first)

    def __len__(self) -> int:
        return len(self.given)

    def __call__(
        self, x: np.ndarray, parameters: Parameters | complex, t: np.ndarray | None = None
    ) -> np.ndarray:
        """Return the values at points (n, d), positive on the side of the motions, shape (n, events).

        Raises
        ------
        NotEvaluable
            If a function fails or returns no number.
        """
        found = np.empty((len(x), len(self.given)))
        for k, function in enumerate(self.functions):
            function.find(self.agree, x, parameters, t)
            try:
                found[:, k] = function(x, parameters, t)
            except Exception as error:  # a user's function may fail in any way
                raise NotEvaluable(f"the event {self.names[k]} fails: {error}") from error
        return found * self.signs

    def closest(
        self,
        motion: Callable[[np.ndarray], np.ndarray],
        edges: np.ndarray,
        period: float,
        parameters: Parameters | complex,
    ) -> tuple[np.ndarray, np.ndarray]:
        """Return the smallest value of each event along a periodic motion, and its place in units of the period.

        Parameters
        ----------
        motion : callable
            Places in units of the period -> states (n, d).
        edges : ndarray
            Places in increasing order, so close that an event has at most one minimum between two of them.
        """

        def values(places: np.ndarray) -> np.ndarray:
            return self(motion(places), parameters, places * period if self.forced else None)

        count, smallest, place_of = len(edges), np.empty(len(self)), np.empty(len(self))
        rough = values(edges)
        for k in range(len(self)):
            j = int(np.argmin(rough[:, k]))
            low, high = edges[j - 1] - (j == 0), edges[(j + 1) % count] + (j == count - 1)
            places, along, i = np.empty(0), np.empty(0), 1
            for _ in range(ROUNDS):
                places = np.linspace(low, high, CLOSER + 1)
                along = values(places)[:, k]
                i = min(max(int(np.argmin(along)), 1), CLOSER - 1)
                low, high = places[i - 1], places[i + 1]
            left, middle, right = along[i - 1 : i + 2]
            bend = left - 2.0 * middle + right
            step = min(max(0.5 * (left - right) / bend, -1.0), 1.0) if bend > 0.0 else 0.0
            inside = bend > 0.0 and abs(step) < 1.0
            smallest[k] = middle - 0.125 * (right - left) ** 2 / bend if inside else along.min()
            place_of[k] = places[i] + step * (places[1] - places[0])
        return smallest, place_of % 1.0

    def crossings(self, values: ParameterSet, p: float) -> Sequence[Callable]:
        """Return the events as terminal event functions of scipy's integrators."""
        parameters = values.at(p)

        def stopping(sign: float, function: AtPoints) -> Callable:
            def value(t: float, x: np.ndarray) -> float:
                return sign * float(function._call(x, parameters, t))  # type: ignore[arg-type]

            value.terminal, value.direction = True, -1.0  # pyright: ignore[reportFunctionMemberAccess]
            return value

        return [stopping(*each) for each in zip(self.signs, self.functions, strict=True)]
