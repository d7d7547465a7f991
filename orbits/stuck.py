"""The stuck absorber: the motion of the empty word, as an orbit and as a continuation problem.

While friction holds, the absorber rides with the cavity: the reduced machine is then at rest in its frame, the oscillator
answers linearly with the mass 1 + eps. The only border is the slip: where the shaking first beats friction.
"""

from __future__ import annotations

from collections.abc import Hashable, Sequence
from dataclasses import dataclass, field
from types import SimpleNamespace
from typing import Any

import numpy as np

from orbits import measures as measuring
from orbits.models.base import Model
from orbits.monitors import Margin
from orbits.words import Word

EMPTY = Word((), ())


def linear_response(model: Model, params: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Matrix K and right-hand side f of the stuck motion's linear equations K u = f.

    Reduced machine: u is the absorber's position, kept in the middle. Coupled machine: u = (X, Y) of
    q1 = X sin Psi + Y cos Psi with mass 1 + eps, damping eps lambda and base excitation eps G (sin, and cos by the damper).
    """
    if model.node == 2:
        return np.eye(1), np.zeros(1)
    forcing, omega, damping, eps = (float(value) for value in params[:4])
    exact = float(params[7])
    stiffness, drag = 1.0 - (1.0 + eps) * omega**2, eps * damping * omega
    return np.array([[stiffness, -drag], [drag, stiffness]]), eps * forcing * np.array([1.0, exact * drag])


def reserve(model: Model, params: np.ndarray, u: np.ndarray) -> float:
    """Friction acceleration left before the absorber slips: a - C Omega^2, or mu g - max |q1''|."""
    names = model.parameter_names
    if model.node == 2:
        return model.friction_acceleration(params) - float(params[0]) * float(params[5]) ** 2
    pull = float(params[names.index("friction")]) * float(params[names.index("gravity")])
    return pull - float(params[1]) ** 2 * float(np.hypot(u[0], u[1]))


def multipliers(model: Model, params: np.ndarray) -> np.ndarray:
    """Multipliers of the oscillator over one forcing period with the absorber stuck; none for the reduced machine."""
    if model.node == 2:
        return np.zeros(0, complex)
    omega, damping, eps = (float(value) for value in params[1:4])
    roots = np.roots([1.0 + eps, eps * damping, 1.0]).astype(complex)
    return np.exp(roots * 2.0 * np.pi / omega)


class StuckProblem:
    """The stuck motion against one parameter: linear equations with one margin; see `orbits.problem` for the members."""

    spectrum = "map"
    flip_kind = "period-doubling"
    symmetries = ()
    period_shift = None
    n_margins = 1
    word, periods, symmetric = EMPTY, 1, True

    def __init__(self, model: Model, parameter: str, params: np.ndarray) -> None:
        if parameter not in model.parameter_names:
            raise ValueError(
                f"parameter = {parameter!r} is unknown to the model {model.name!r}; choose one of "
                + ", ".join(model.parameter_names)
            )
        self.model, self.parameter, self.params = model, parameter, np.array(params, dtype=float)
        self.index = model.parameter_names.index(parameter)
        self.dimension = 1 if model.node == 2 else 2
        self.n_multipliers = 0 if model.node == 2 else 2
        self.data = self

    @property
    def kernels(self) -> Any:
        """linearise, bordered, inspect in plain Python: three equations need no compiler."""
        return SimpleNamespace(
            linearise=_linearise, bordered=_bordered, inspect=_inspect, compiled=False, digest="stuck"
        )

    def workspace(self) -> tuple[np.ndarray, ...]:
        """Residual, Jacobian and derivative with respect to the parameter."""
        n = self.dimension
        return np.zeros(n), np.zeros((n, n)), np.zeros(n)

    def values(self, p: float) -> np.ndarray:
        """The parameter vector at parameter value `p`."""
        params = self.params.copy()
        params[self.index] = p
        return params

    def margin_kind(self, j: int) -> str:
        """The one border is the slip."""
        return "stick"

    def to_multipliers(self, spectrum: np.ndarray) -> np.ndarray:
        """Multipliers of the forcing period."""
        return np.asarray(spectrum, dtype=complex)

    def offspring(self, *_: Any) -> list[Any]:
        """A linear motion has no branches."""
        return []

    def beyond(self, point: Any) -> Sequence[Any]:
        """The stick-slip motion that begins where friction gives way."""
        from orbits.borders import from_rest

        return from_rest(self, point)

    def canonical(self, u: np.ndarray, p: float) -> tuple[Hashable, np.ndarray]:
        """One key for all stuck motions of a machine."""
        return ("stuck", self.model.name), np.array(u, dtype=float)

    @property
    def measure_names(self) -> tuple[str, ...]:
        """Measures: as for all orbits of the machine."""
        return measuring.names(self.model)

    def measures(self, names: Sequence[str], u: np.ndarray, p: np.ndarray) -> dict[str, np.ndarray]:
        """Measures of many solutions at once; velocities at impacts are not a number."""
        u, p = np.atleast_2d(u), np.atleast_1d(p)
        result = {}
        for name in names:
            if name not in self.measure_names:
                raise KeyError(f"measure {name!r} is unknown; choose one of {', '.join(self.measure_names)}")
            result[name] = np.array([self._measure(name, row, self.values(value)) for row, value in zip(u, p)])
        return result

    def _measure(self, name: str, u: np.ndarray, params: np.ndarray) -> float:
        if name in ("impact_loss", "friction_loss", "impact_speed", "impact_speed_min", "max_abs_w"):
            return 0.0
        if self.model.node == 2:
            return float(params[0]) ** 2 if name == "C2" else np.nan
        eps, size = float(params[3]), float(np.hypot(u[0], u[1]))
        dissipated = float(params[2]) * np.pi * float(params[1]) * size**2  # lambda times the integral of q1'^2
        return {
            "max_abs_q1": size,
            "amplitude": (1.0 + eps) * size,
            "C2": ((1.0 + eps) * size) ** 2,
            "v_phase": float(np.arctan2(u[1], u[0])),
            "input_work": dissipated,
            "damping_loss": dissipated,
        }.get(name, np.nan)

    def orbit(self, u: np.ndarray, p: float) -> StuckOrbit:
        """The solution as an orbit without events."""
        return StuckOrbit(self.model, self.values(p), np.array(u, dtype=float))

    def replay(self, u: np.ndarray, p: float) -> float | None:
        """Largest relative displacement in a simulation of one period from the stuck state."""
        return self.orbit(u, p).replay()

    def describe(self) -> dict[str, Any]:
        """A description that `rebuild` understands, ready for JSON."""
        return {
            "factory": "orbits.stuck:rebuild",
            "name": "stuck",
            "model": self.model.settings(),
            "word": "",
            "periods": 1,
            "impacts": 0,
            "parameter": self.parameter,
            "params": [float(value) for value in self.params],
            "symmetric": True,
        }


def rebuild(description: dict[str, Any]) -> StuckProblem:
    """The problem that `StuckProblem.describe` described."""
    from orbits.models import build

    return StuckProblem(build(description["model"]), description["parameter"], np.array(description["params"]))


def _linearise(data: StuckProblem, u: np.ndarray, p: float, work: tuple[np.ndarray, ...]) -> float:
    F, J, Q = work
    K, f = linear_response(data.model, data.values(p))
    J[:] = K
    F[:] = K @ u - f
    h = 1e-6 * max(1.0, abs(p))
    ahead, f_ahead = linear_response(data.model, data.values(p + h))
    behind, f_behind = linear_response(data.model, data.values(p - h))
    Q[:] = ((ahead @ u - f_ahead) - (behind @ u - f_behind)) / (2.0 * h)
    return float(np.abs(F).max())


def _bordered(data: StuckProblem, work: tuple, border: np.ndarray, target: float, step: np.ndarray, tangent: np.ndarray) -> float:
    F, J, Q = work
    matrix = np.vstack([np.column_stack([J, Q]), border])
    sides = np.column_stack([np.r_[-F, target], np.r_[np.zeros_like(F), 1.0]])
    sign = float(np.linalg.slogdet(matrix)[0])
    solution = np.linalg.solve(matrix, sides) if sign else np.linalg.lstsq(matrix, sides, rcond=None)[0]
    step[:], tangent[:] = solution[:, 0], solution[:, 1]
    return sign


def _inspect(data: StuckProblem, u: np.ndarray, p: float, work: tuple, row: np.ndarray) -> None:
    params = data.values(p)
    spectrum = multipliers(data.model, params)
    row[: 2 * spectrum.size : 2], row[1 : 2 * spectrum.size : 2] = spectrum.real, spectrum.imag
    row[-1] = reserve(data.model, params, u)


@dataclass(frozen=True, eq=False)
class StuckOrbit:
    """The motion without events; offers what `orbits.orbit.Orbit` offers.

    Attributes
    ----------
    model : Model
    params : float array (P,)
    u : float array
        Unknowns of `StuckProblem`.
    """

    model: Model
    params: np.ndarray = field(repr=False)
    u: np.ndarray = field(repr=False)

    word, periods, impacts, symmetric = EMPTY, 1, 0, True

    @classmethod
    def of(cls, model: Model, params: np.ndarray) -> StuckOrbit:
        """The stuck motion at these parameters; `real` tells whether friction holds."""
        K, f = linear_response(model, params)
        return cls(model, params, np.linalg.solve(K, f))

    @property
    def nodes(self) -> np.ndarray:
        """No nodes, shape (0, n)."""
        return np.zeros((0, self.model.node))

    @property
    def parameters(self) -> dict[str, float]:
        """All parameters by name."""
        return dict(zip(self.model.parameter_names, (float(value) for value in self.params), strict=True))

    @property
    def multipliers(self) -> np.ndarray:
        """Multipliers of the oscillator over one forcing period."""
        return multipliers(self.model, self.params)

    @property
    def stable(self) -> bool:
        """Whether the oscillator is damped (the reduced machine stays where it is)."""
        return bool(np.all(np.abs(self.multipliers) < 1.0))

    @property
    def margin(self) -> float:
        """Reserve of friction."""
        return reserve(self.model, self.params, self.u)

    @property
    def margins(self) -> list[Margin]:
        """The one margin."""
        return [Margin("stick", 0, self.margin)]

    @property
    def real(self) -> bool:
        """Whether friction holds."""
        return self.margin > -1e-9

    @property
    def residual(self) -> float:
        """Largest residual of the linear equations."""
        K, f = linear_response(self.model, self.params)
        return float(np.abs(K @ self.u - f).max())

    def root(self) -> StuckOrbit:
        """Itself."""
        return self

    def problem(self, parameter: str | None = None, symmetric: bool | None = None) -> StuckProblem:
        """The stuck motion as a continuation problem."""
        return StuckProblem(self.model, parameter or self.model.default_parameter, self.params)

    def seed(self, problem: StuckProblem) -> tuple[np.ndarray, float]:
        """Unknowns and parameter value."""
        return self.u.copy(), float(self.params[problem.index])

    def measure(self, name: str) -> float:
        """One measure."""
        problem = self.problem()
        return float(problem.measures([name], self.u[None], np.array([self.params[problem.index]]))[name][0])

    def sample(self, points: int = 400) -> dict[str, np.ndarray]:
        """Positions and velocities over one forcing period; keys as in `orbits.sampling.sample`."""
        phase = np.linspace(0.0, 2.0 * np.pi, points)
        eps, omega = self.parameters["mass_ratio"], self.parameters["frequency"]
        if self.model.node == 2:
            v, v_rate = self.params[0] * np.sin(phase), self.params[0] * omega * np.cos(phase)
        else:
            X, Y = (1.0 + eps) * self.u
            v = X * np.sin(phase) + Y * np.cos(phase)
            v_rate = omega * (X * np.cos(phase) - Y * np.sin(phase))
        nothing = np.zeros_like(phase)
        place = v / (1.0 + eps)
        return {
            "tau": phase / omega, "phase": phase, "w": nothing, "w_rate": nothing, "v": v, "v_rate": v_rate,
            "cavity": place, "absorber": place, "segment": np.zeros(points, int),
        }  # fmt: skip

    def replay(self) -> float:
        """Largest relative displacement in a simulation of two periods from the stuck state."""
        from orbits.simulation.driver import simulate

        motion = self.sample(5)
        start = {"phase": 0.0, "w": 0.0, "w_rate": 0.0}
        if self.model.node == 4:
            start |= {"v": float(motion["v"][0]), "v_rate": float(motion["v_rate"][0])}
        own = self.model.settings()
        given = {name: value for name, value in self.parameters.items() if name not in own}
        changed = {name: value for name, value in self.parameters.items() if name in own and name != "excitation"}
        run = simulate(self.model.changed(**changed), start, periods=2.0, **given)
        return float(np.abs(run.sample().w).max())

    @property
    def events(self) -> measuring.EventTable:
        """No events: empty arrays."""
        return measuring.EventTable(*(np.zeros(0) for _ in range(8)))

    def plot(self, **options: Any) -> Any:
        """Phase portrait and time history."""
        from orbits.plots.portrait import portrait

        return portrait(self, **options)  # type: ignore[arg-type]

    def to_dict(self) -> dict[str, Any]:
        """The orbit as JSON."""
        return {
            "word": "",
            "periods": 1,
            "impacts": 0,
            "symmetric": True,
            "parameters": self.parameters,
            "nodes": [],
            "multipliers": [[float(value.real), float(value.imag)] for value in self.multipliers],
            "margins": [{"kind": m.kind, "segment": m.segment, "value": m.value} for m in self.margins],
            "real": self.real,
            "residual": self.residual,
        }
