"""Simulation of flows: one motion until it recurs, by scipy's integrators; many motions at once, by the method of Dormand and Prince.

The latter has order five, and each motion has its own step length: J. Comput. Appl. Math. 6 (1980) 19, table 2. scipy's integrators are imported
only when they are used, since the import takes longer than a diagram of a small flow.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, NamedTuple, cast

import numpy as np

from contvines.shared.numbers import ROUNDED

from ..problems.functions import NotEvaluable

if TYPE_CHECKING:
    from scipy.integrate._ivp.ivp import OdeResult

    from .field import Field


SAMPLES = 400  # states per period of a result
FIRST = 50.0  # length of the first transient, in the fastest time scale at the start
CAUTION = 10.0  # distance at which an equilibrium counts as reached, in tolerances of the simulation
DOUBLINGS = 12  # default for the doublings of the transient
BRIEF = 100  # a simulation with no more integrator steps does not count as a doubling: in a stiff flow the first transients are very short
MOST = 80  # most simulations that do not count
STEPS = 1000  # number of integrator steps in which a motion must move by as many error tolerances
FIRST_STEP = 0.001  # first step, in units of the time in which a motion moves by its size
# step control: safety factor, smallest and largest ratio of successive steps
SAFETY, SHRINK, GROW = 0.9, 0.2, 5.0
# coefficients of Dormand and Prince: times and weights of the stages, weights of the result, of its error
PLACES = (0.2, 0.3, 0.8, 8 / 9, 1.0)
STAGES = [
    np.array([1 / 5]),
    np.array([3 / 40, 9 / 40]),
    np.array([44 / 45, -56 / 15, 32 / 9]),
    np.array([19372 / 6561, -25360 / 2187, 64448 / 6561, -212 / 729]),
    np.array([9017 / 3168, -355 / 33, 46732 / 5247, 49 / 176, -5103 / 18656]),
]
WHOLE = np.array([35 / 384, 0, 500 / 1113, 125 / 192, -2187 / 6784, 11 / 84])
ERROR = np.array([-71 / 57600, 0, 71 / 16695, -71 / 1920, 17253 / 339200, -22 / 525, 1 / 40])


class Place(NamedTuple):
    """Time, state and rate of a motion."""

    t: float
    x: np.ndarray
    rate: np.ndarray


class Interpolant:
    """A motion through given places, interpolated by cubic Hermite polynomials; it has the interface of scipy's results."""

    def __init__(self, places: Sequence[Place]) -> None:
        self.t = np.array([place.t for place in places])
        self.y, self.rates = (np.column_stack([place[k] for place in places]) for k in (1, 2))

    def sol(self, time: np.ndarray | float) -> np.ndarray:
        """Return the states at times, shape (d, ...)."""
        i = np.clip(np.searchsorted(self.t, time) - 1, 0, len(self.t) - 2)
        h = self.t[i + 1] - self.t[i]
        s = (time - self.t[i]) / h
        a, b = self.y[:, i], self.y[:, i + 1]
        bent = (1.0 - s) * (h * self.rates[:, i] - b + a) - s * (h * self.rates[:, i + 1] - b + a)
        return (1.0 - s) * a + s * b + s * (1.0 - s) * bent


class AtRest(ValueError):
    """The motion comes to rest at `state`."""

    def __init__(self, state: np.ndarray) -> None:
        self.state = state
        super().__init__(
            f"the motion comes to rest at {np.array2string(state, precision=6)}; contvines.diagram of the flow follows equilibria"
        )


class Escaped(ValueError):
    """The motion escapes: it cannot be simulated any further."""


class Stopped(ValueError):
    """An event of the flow stops the motion."""


class Irregular(ValueError):
    """The motion does not recur."""


def recurrence(
    field: Field,
    p: float,
    x: np.ndarray,
    transient: float | None,
    longest: int,
    doublings: int = DOUBLINGS,
) -> tuple[np.ndarray, np.ndarray, int]:
    """Simulate a motion until it recurs; return times and states of one period, and the number of forcing periods in it (1 if autonomous).

    Raises
    ------
    ValueError
        If the motion escapes, comes to rest, or does not recur.
    """
    settled = _forced if field.forced else _free
    try:
        return settled(field, p, x, transient, longest, doublings)
    except NotEvaluable as error:
        raise Escaped(f"the motion cannot be simulated: {error}") from error


def _run(
    field: Field, p: float, x: np.ndarray, start: float, stop: float, dense: bool = False, rough: bool = False
) -> OdeResult:
    from scipy.integrate import solve_ivp

    s, size = field.settings, field.lengths + np.abs(x)
    rate, largest = field.rate_at(p), s.endless * size
    relative, absolute = (s.rough_relative, s.rough_absolute) if rough else (s.relative, s.absolute)
    calls, before = 0, start

    def bounded(t: float, y: np.ndarray) -> np.ndarray:
        nonlocal calls, before
        if not (np.abs(y) < largest).all():
            raise Escaped(f"the motion escapes: it cannot be simulated beyond t = {t:.6g}")
        found, calls = rate(t, y), calls + 1
        if calls % (STEPS * (1 + len(y))) == 0:  # at most 1 + d calls a step
            speed = float((np.abs(found) / (absolute * size + relative * np.abs(y))).max())
            if speed * (t - before) < STEPS and speed * (stop - start) > STEPS**2:
                raise Irregular(
                    f"the motion cannot be simulated beyond t = {t:.6g}: f jumps or has a pole at {np.array2string(y, precision=6)}, "
                    "so that steps become shorter than its error allows; give a smooth f (friction and walls: a machine of orbits)"
                )
            before = t
        return found

    found = solve_ivp(
        bounded,
        (start, stop),
        x,
        method="LSODA",
        rtol=relative,
        atol=cast("float", absolute * size),
        dense_output=dense,
        events=field.events.crossings(field.values, p) or None,
    )
    if found.status == 1:
        name = next(name for name, times in zip(field.events.names, found.t_events) if len(times))
        raise Stopped(
            f"the event {name} stops the motion at {np.array2string(found.y[:, -1], precision=6)}; begin elsewhere, or with other parameters"
        )
    if found.status != 0 or not np.isfinite(found.y[:, -1]).all():
        raise Escaped(f"the motion escapes: it cannot be simulated beyond t = {found.t[-1]:.6g}")
    return found


def _forced(
    field: Field, p: float, x: np.ndarray, transient: float | None, longest: int, doublings: int
) -> tuple[np.ndarray, np.ndarray, int]:
    period, s = float(field.length_of_period(p)), field.settings
    count = 100 if transient is None else max(1, int(np.ceil(transient / period)))
    for _ in range(doublings if transient is None else 1):
        x = _run(field, p, x, 0.0, count * period, rough=True).y[:, -1]
        points = [x]
        low = high = x
        for k in range(1, longest + 1):
            run = _run(field, p, points[-1], 0.0, period)
            points.append(run.y[:, -1])
            low, high = np.minimum(low, run.y.min(axis=1)), np.maximum(high, run.y.max(axis=1))
            extents = (high - low) / field.lengths
            near = s.recurs * np.maximum(extents, s.least * extents.max()) + s.still
            if (np.abs(points[-1] - points[0]) <= near * field.lengths).all():
                run_again = _run(field, p, points[0], 0.0, k * period, dense=True)
                times = np.linspace(0.0, k * period, SAMPLES * k + 1)
                return times, run_again.sol(times).T, k
        x, count = points[-1], 2 * count
        if count > 20000:
            break
    raise Irregular(
        f"the motion has not become periodic after {count} periods of the forcing; it may be chaotic: try another x0 or other parameters"
    )


def _free(
    field: Field, p: float, x: np.ndarray, transient: float | None, longest: int, doublings: int
) -> tuple[np.ndarray, np.ndarray, int]:
    rate, s = field.rate_at(p), field.settings
    matrix = field.jacobian(x[None, :], p)[0]
    fastest = float(np.abs(np.linalg.eigvals(matrix)).max())
    span = transient if transient is not None else FIRST / (fastest if fastest > 0.0 else 1.0)
    if not rate(0.0, x).any():
        # the start is an equilibrium: move off it, in the positive direction since concentrations may be zero there
        x = x + s.beside * field.lengths / np.arange(1.0, len(x) + 1)
    x = _run(field, p, x, 0.0, span, rough=True).y[:, -1]
    brief = 0
    while doublings > 0 and brief < MOST:
        run = _run(field, p, x, 0.0, span, dense=True, rough=True)
        doublings -= len(run.t) > BRIEF
        brief += len(run.t) <= BRIEF
        ranges = np.ptp(run.y, axis=1)
        resting = (ranges <= s.still * (field.lengths + np.abs(x))).all()
        rest = x if resting else _equilibrium_at(field, p, run.y[:, -1])
        if rest is not None:
            raise AtRest(rest)
        plane, unit = _fastest(field, p, run)
        if _last_return(run, plane, s.nearly * unit, longest) is not None:
            exact = _run(field, p, plane.x, 0.0, span, dense=True)
            found = _last_return(exact, plane, s.recurs * unit, longest)
            if found is not None:
                start, period = exact.sol(found[0]), found[1] - found[0]
                run_again = _run(field, p, start, 0.0, period, dense=True)
                times = np.linspace(0.0, period, SAMPLES + 1)
                return times, run_again.sol(times).T, 1
        x, span = run.y[:, -1], 2.0 * span
    raise Irregular(
        "the motion has not become periodic; it may be chaotic, or settle slowly: try another x0, other parameters or transient="
    )


def last_round(
    field: Field, p: float, places: Sequence[Place], longest: int
) -> tuple[np.ndarray, np.ndarray] | None:
    """Return times and states of the last period of a motion through given places; None if it does not recur."""
    settled = places[len(places) // 2 :]
    if len(settled) < 2:
        return None
    motion, (plane, unit) = Interpolant(places), _fastest(field, p, Interpolant(settled))
    found = _last_return(motion, plane, field.settings.recurs * unit, longest)
    if found is None:
        return None
    times = np.linspace(*found, SAMPLES + 1)
    return times, motion.sol(times).T


def _fastest(field: Field, p: float, run: OdeResult | Interpolant) -> tuple[Place, np.ndarray]:
    """The place at which a motion is fastest relative to its size, with its rate divided by the squared sizes (normal of a plane), and the sizes."""
    extents = np.ptp(run.y, axis=1) / field.lengths
    unit = field.lengths * np.maximum(extents, field.settings.least * extents.max())
    rates = field(run.y.T, p)
    i = int(np.argmax(np.linalg.norm(rates / unit, axis=1)))
    return Place(float(run.t[i]), run.y[:, i], rates[i] / unit**2), unit


def _equilibrium_at(field: Field, p: float, x: np.ndarray) -> np.ndarray | None:
    """The stable equilibrium at a state, within the errors of a rough simulation; None if there is none."""
    s, matrix = field.settings, field.jacobian(x[None], p)[0]
    try:
        step = np.linalg.solve(matrix, -field(x[None], p)[0])
    except np.linalg.LinAlgError:
        return None
    near = (np.abs(step) <= CAUTION * s.rough_relative * (field.lengths + np.abs(x))).all()
    return x + step if near and (np.linalg.eigvals(matrix).real < 0.0).all() else None


def _last_return(
    run: OdeResult | Interpolant, plane: Place, close: np.ndarray, longest: int
) -> tuple[float, float] | None:
    """The last two times at which a motion crosses a plane in the same state; None if it does not return to the same state."""
    heights = plane.rate @ (run.y - plane.x[:, None])
    passed = np.flatnonzero((heights[:-1] < 0.0) & (heights[1:] >= 0.0))[-longest - 1 :]
    if len(passed) < 2:
        return None
    end = _crossing(run, plane, int(passed[-1]))
    last = run.sol(end)
    for i in passed[-2::-1]:
        time = _crossing(run, plane, int(i))
        if (np.abs(run.sol(time) - last) <= close).all():
            return time, end
    return None


def _crossing(run: OdeResult | Interpolant, plane: Place, i: int) -> float:
    """Time at which a motion crosses a plane within step i of the integrator, by bisection."""
    low, high = float(run.t[i]), float(run.t[i + 1])
    for _ in range(60):
        middle = 0.5 * (low + high)
        if plane.rate @ (run.sol(middle) - plane.x) < 0.0:
            low = middle
        else:
            high = middle
    return 0.5 * (low + high)


class March:
    """Integration of many motions at once, in any number of calls.

    Parameters
    ----------
    field : Field
    p : float
    x : ndarray, shape (n, d) or (n, 2 d)
        Initial states; with 2 d columns each is followed by a perturbation, which is integrated by the linearised flow.
    size : ndarray, shape (d,) or (2 d,)
        Typical size of each column.
    """

    def __init__(self, field: Field, p: float, x: np.ndarray, size: np.ndarray) -> None:
        self.field, self.p, self.size = field, p, size
        self.vectors = x.shape[1] > field.node
        self.x, self.t = np.array(x, dtype=float), np.zeros(len(x))
        with np.errstate(all="ignore"):
            self.slope = self._rates(self.x, self.t)
        speed = np.abs(self.slope / size).max(axis=1)
        self.h = FIRST_STEP / np.where(np.isfinite(speed) & (speed > 0.0), speed, 1.0)
        self.steps = 0
        self.stopped = np.zeros(len(x), dtype=bool)  # by an event of the flow
        self._stop(np.arange(len(x)))

    def _rates(self, x: np.ndarray, t: np.ndarray) -> np.ndarray:
        field, d, times = self.field, self.field.node, t if self.field.forced else None
        try:
            if self.vectors:
                return np.concatenate(field.carried(x[:, :d], x[:, d:], self.p, times), axis=1)
            return np.asarray(field(x, self.p, times), dtype=float)
        except NotEvaluable:
            if len(x) == 1:
                return np.full(x.shape, np.nan)
            return np.concatenate([self._rates(x[i : i + 1], t[i : i + 1]) for i in range(len(x))])

    def _stop(self, rows: np.ndarray) -> None:
        """Set motions that are beyond an event to NaN."""
        field = self.field
        if self.vectors or not len(field.events) or not rows.size:
            return
        with np.errstate(all="ignore"):
            beyond = (field.events(self.x[rows], field.values.at(self.p), self.t[rows]) < 0.0).any(axis=1)
        self.stopped[rows[beyond]] = True
        self.x[rows[beyond]] = np.nan

    def go(
        self,
        rows: np.ndarray,
        steps: int,
        until: float = np.inf,
        far: float = np.inf,
        paths: Mapping[int, list[Place]] | None = None,
    ) -> None:
        """Integrate the motions `rows` for a number of steps, or until a time; a motion that fails or moves beyond `far` sizes becomes NaN.

        `paths` collects the places after each step, for the motions that are its keys.
        """
        relative, absolute = self.field.settings.rough_relative, self.field.settings.rough_absolute
        for _ in range(steps):
            rows = rows[np.isfinite(self.x[rows, 0]) & (self.t[rows] < until)]
            if not rows.size:
                return
            x, t, h = self.x[rows], self.t[rows], np.minimum(self.h[rows], until - self.t[rows])
            k = np.empty((7, *x.shape))
            k[0] = self.slope[rows]
            with np.errstate(all="ignore"):
                for s, (place, weights) in enumerate(zip(PLACES, STAGES, strict=True), start=1):
                    k[s] = self._rates(x + h[:, None] * _weighted(weights, k[:s]), t + place * h)
                new = x + h[:, None] * _weighted(WHOLE, k[:6])
                k[6] = self._rates(new, t + h)
                wrong = h[:, None] * _weighted(ERROR, k)
                allowed = absolute * self.size + relative * np.maximum(np.abs(x), np.abs(new))
                error = np.sqrt(np.mean((wrong / allowed) ** 2, axis=1))
                factor = np.clip(SAFETY * error**-0.2, SHRINK, GROW)
            good = error <= 1.0
            took = rows[good]
            self.x[took], self.t[took], self.slope[took] = new[good], (t + h)[good], k[6][good]
            for i, path in (paths or {}).items():
                if good[rows == i].any():
                    path.append(Place(float(self.t[i]), self.x[i].copy(), self.slope[i].copy()))
            self._stop(took)
            full_step = h == self.h[rows]
            with np.errstate(all="ignore"):
                scaled = np.where(full_step | ~good, h * factor, self.h[rows])
            self.h[rows] = np.where(np.isfinite(error), scaled, SHRINK * h)
            lost = (np.abs(self.x[rows]) > far * self.size).any(axis=1) | (
                h < ROUNDED * np.maximum(1.0, np.abs(t))
            )
            self.x[rows[lost]] = np.nan
            self.steps += len(rows)


def _weighted(weights: np.ndarray, k: np.ndarray) -> np.ndarray:
    """Weighted sum of rates (s, n, d), shape (n, d)."""
    return (weights @ k.reshape(len(k), -1)).reshape(k.shape[1:])
