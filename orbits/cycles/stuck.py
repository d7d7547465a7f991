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
    from orbits.proofs import Proof

EMPTY = Word((), ())


@dataclass(frozen=True, eq=False, repr=False)
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
    spelling = ""

    def __repr__(self) -> str:
        values = ", ".join(f"{name}={value:.10g}" for name, value in self.parameters.items())
        return f"StuckOrbit({self.model.name}, {values})"

    @classmethod
    def of(cls, model: Model, params: np.ndarray) -> StuckOrbit:
        """The stuck motion at these parameters; `real` tells whether friction holds."""
        K, f = model.rest.equations(params)
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
        return self.model.rest.multipliers(self.params)

    @property
    def stable(self) -> bool:
        """Whether the oscillator is damped (the reduced machine stays where it is)."""
        return bool(np.all(np.abs(self.multipliers) < 1.0))

    @property
    def margin(self) -> float:
        """Reserve of friction."""
        return self.model.rest.reserve(self.params, self.u)

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
        K, f = self.model.rest.equations(self.params)
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
        v, v_rate = self.model.rest.cavity_motion(self.params, self.u, phase)
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
        start |= {name: float(motion[name][0]) for name in self.model.node_names[2:]}
        run = simulate(self.model, start, periods=2.0, **self.parameters)  # type: ignore[arg-type]
        return float(np.abs(run.sample().w).max())

    def prove(self, bits: int | None = None, **parameters: Any) -> Proof:
        """Prove that friction holds, or not; see `orbits.proofs.subjects.of_orbit`."""
        from orbits.proofs.subjects import of_orbit

        return of_orbit(self, bits, **parameters)

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
            **self.model.described(self.params),
            "nodes": [],
            "multipliers": [[float(value.real), float(value.imag)] for value in self.multipliers],
            "margins": [{"kind": m.kind, "segment": m.segment, "value": m.value} for m in self.margins],
            "real": self.real,
            "residual": self.residual,
        }
