"""The stuck absorber: the motion of the empty word, as an orbit.

While friction holds, the absorber rides with the cavity: the reduced machine is then at rest in its frame, the oscillator
answers linearly with the mass 1 + eps. The only border is the slip: where the shaking first beats friction.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

from orbits.cycles import measures as measuring
from orbits.cycles.margins import Margin
from orbits.machines.base import Model
from orbits.words import Word

if TYPE_CHECKING:
    from orbits.cycles.stuck_problem import StuckProblem

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


@dataclass(frozen=True, eq=False)
class StuckOrbit:
    """The motion without events; offers what `orbits.orbit.Orbit` offers.

    Attributes
    ----------
    model : Model
    params : float array (P,)
    u : float array
        Unknowns of `orbits.cycles.stuck_problem.StuckProblem`.
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
        from orbits.cycles.stuck_problem import StuckProblem

        return StuckProblem(self.model, parameter or self.model.default_parameter, self.params)

    def seed(self, problem: StuckProblem) -> tuple[np.ndarray, float]:
        """Unknowns and parameter value."""
        return self.u.copy(), problem.value(self.params)

    def measure(self, name: str) -> float:
        """One measure."""
        problem = self.problem()
        return float(problem.measures([name], self.u[None], np.array([problem.value(self.params)]))[name][0])

    def sample(self, points: int = 400) -> dict[str, np.ndarray]:
        """Positions and velocities over one forcing period; keys as in `orbits.cycles.sampling.sample`."""
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
        changed = {
            name: value for name, value in self.parameters.items() if name in own and name != "excitation"
        }
        run = simulate(self.model.changed(**changed), start, periods=2.0, **given)  # type: ignore[arg-type]
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
