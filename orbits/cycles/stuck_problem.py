"""The stuck absorber as a continuation problem: linear equations with one margin."""

from __future__ import annotations

from collections.abc import Hashable, Mapping, Sequence
from types import SimpleNamespace
from typing import Any

import numpy as np

from orbits.cycles import measures as measuring
from orbits.cycles.stuck import EMPTY, StuckOrbit
from orbits.machines.base import Model
from orbits.machines.path import along


class StuckProblem:
    """The stuck motion against one parameter: linear equations with one margin; see `orbits.problem` for the members."""

    spectrum = "map"
    flip_kind = "period-doubling"
    symmetries = ()
    period_shift = None
    n_margins = 1
    word, periods, symmetric = EMPTY, 1, True

    def __init__(self, model: Model, parameter: str, params: np.ndarray) -> None:
        self.model, self.parameter, self.params = model, parameter, np.array(params, dtype=float)
        self.path = model.path(parameter, self.params)
        self.dimension = model.rest.unknowns
        self.n_multipliers = model.rest.multipliers(self.params).size
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

    def values(self, p: float | np.ndarray) -> np.ndarray:
        """The parameter vector at parameter value `p`."""
        return along(self.path, self.params, p)

    def value(self, params: np.ndarray) -> float:
        """The value of the parameter that varies in a parameter vector."""
        return self.model.amount(self.parameter, params)

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
        from orbits.borders.sticking import from_rest

        return from_rest(self, point)

    def canonical(self, u: np.ndarray, p: float) -> tuple[Hashable, np.ndarray]:
        """One key for all stuck motions of a machine."""
        return ("stuck", self.model.name), np.array(u, dtype=float)

    @property
    def measure_names(self) -> tuple[str, ...]:
        """Measures: as for all orbits of the machine."""
        return measuring.names(self.model)

    @property
    def angles(self) -> tuple[str, ...]:
        """Measures that are angles: they jump by 2 pi without a jump of the orbit."""
        return measuring.ANGLES

    @property
    def default_measure(self) -> str:
        """The measure that a diagram shows when none is asked for."""
        return self.model.default_measure

    def measures(self, names: Sequence[str], u: np.ndarray, p: np.ndarray) -> dict[str, np.ndarray]:
        """Measures of many solutions at once; velocities at impacts are not a number."""
        u, p = np.atleast_2d(u), np.atleast_1d(p)
        result = {}
        for name in names:
            if name not in self.measure_names:
                raise KeyError(f"measure {name!r} is unknown; choose one of {', '.join(self.measure_names)}")
            result[name] = np.array(
                [self._measure(name, row, self.values(value)) for row, value in zip(u, p)]
            )
        return measuring.gauged(self.model, self.values(p), result)

    def _measure(self, name: str, u: np.ndarray, params: np.ndarray) -> float:
        name = measuring.MEANS.get(name, name)  # its period is the forcing's
        if name in ("impact_loss", "friction_loss", "impact_speed", "impact_speed_min", "max_abs_w"):
            return 0.0
        return self.model.rest.measure(name, params, u)

    def orbit(self, u: np.ndarray, p: float) -> StuckOrbit:
        """The solution as an orbit without events."""
        return StuckOrbit(self.model, self.values(p), np.array(u, dtype=float))

    def root(self, u: np.ndarray, p: float) -> None:
        """No motion without events repeats a shorter one."""

    def replay(self, u: np.ndarray, p: float) -> float | None:
        """Largest relative displacement in a simulation of one period from the stuck state."""
        return self.orbit(u, p).replay()

    def prove(
        self, kind: str, u: np.ndarray, p: float, margin: int | None = None, bits: int | None = None
    ) -> Any:
        """Prove a special point of this problem; see `orbits.proofs.subjects.of_point`."""
        from orbits.proofs.subjects import of_point

        return of_point(self, kind, u, p, margin, bits)

    def describe(self) -> dict[str, Any]:
        """A description that `rebuild` understands, ready for JSON."""
        return {
            "factory": "orbits.cycles.stuck_problem:rebuild",
            "name": "stuck",
            "model": self.model.settings(),
            "word": "",
            "periods": 1,
            "impacts": 0,
            "parameter": self.parameter,
            "params": [float(value) for value in self.params],
            **({"units": self.model.units} if self.model.units else {}),
            "symmetric": True,
        }


def rebuild(description: Mapping[str, Any], trust: bool = False) -> StuckProblem:
    """The problem that `StuckProblem.describe` described; it holds data only, so `trust` has no meaning here."""
    from orbits.machines.catalogue import build

    return StuckProblem(
        build(description["model"]), description["parameter"], np.array(description["params"])
    )


def _linearise(data: StuckProblem, u: np.ndarray, p: float, work: tuple[np.ndarray, ...]) -> float:
    F, J, Q = work
    K, f = data.model.rest.equations(data.values(p))
    J[:] = K
    F[:] = K @ u - f
    h = 1e-6 * (abs(p) or 1.0)  # whatever the unit of p
    ahead, f_ahead = data.model.rest.equations(data.values(p + h))
    behind, f_behind = data.model.rest.equations(data.values(p - h))
    Q[:] = ((ahead @ u - f_ahead) - (behind @ u - f_behind)) / (2.0 * h)
    return float(np.abs(F).max())


def _bordered(
    data: StuckProblem, work: tuple, border: np.ndarray, target: float, step: np.ndarray, tangent: np.ndarray
) -> float:
    F, J, Q = work
    matrix = np.vstack([np.column_stack([J, Q]), border])
    sides = np.column_stack([np.r_[-F, target], np.r_[np.zeros_like(F), 1.0]])
    sign = float(np.linalg.slogdet(matrix)[0])
    solution = np.linalg.solve(matrix, sides) if sign else np.linalg.lstsq(matrix, sides, rcond=None)[0]
    step[:], tangent[:] = solution[:, 0], solution[:, 1]
    return sign


def _inspect(data: StuckProblem, u: np.ndarray, p: float, work: tuple, row: np.ndarray) -> None:
    params = data.values(p)
    spectrum = data.model.rest.multipliers(params)
    row[: 2 * spectrum.size : 2] = np.real(spectrum)
    row[1 : 2 * spectrum.size : 2] = np.imag(spectrum)
    row[-1] = data.model.rest.reserve(params, u)
