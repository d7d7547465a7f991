"""What equilibria, cycles and many starts ask of their flow (`contvines.flows.problem.FlowProblem`)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np

from ..problems.protocol import Problem

if TYPE_CHECKING:
    from ..problems.algebraic import AlgebraicProblem
    from ..problems.images import Image
    from ..problems.parameters import ParameterSet
    from ..problems.populations import Population
    from ..problems.protocol import BorderPoint, Seed
    from .collocation import Rule
    from .events import Events
    from .field import Field
    from .settings import FlowSettings


class Born(Problem, Protocol):
    """Cycles that are born at a Hopf point."""

    @property
    def rule(self) -> Rule: ...
    @property
    def node_scale(self) -> np.ndarray: ...


class Flow(Protocol):
    """A flow, as its solutions know it."""

    @property
    def degree(self) -> int: ...
    @property
    def error(self) -> float: ...
    @property
    def settings(self) -> FlowSettings: ...
    @property
    def field(self) -> Field: ...
    @property
    def events(self) -> Events: ...
    @property
    def mirror(self) -> Image | None: ...
    @property
    def mirror_shifted(self) -> bool: ...
    @property
    def states(self) -> tuple[str, ...]: ...
    @property
    def of_states(self) -> Mapping[str, tuple[str, int]]: ...
    @property
    def of_cycles(self) -> Mapping[str, str]: ...
    @property
    def own_measures(self) -> tuple[str, ...]: ...
    def measure_own(self, name: str, problem: Problem, u: np.ndarray, p: float) -> float: ...
    def equilibria(
        self, parameter: str | None = None, values: Mapping[str, float] | None = None
    ) -> AlgebraicProblem: ...
    def cycles(
        self,
        field: Field,
        u: np.ndarray,
        intervals: int,
        rounds: int,
        copies: int,
        scale: np.ndarray,
        clock: float,
        unit: float,
    ) -> Born: ...
    def population(
        self,
        over: str | None = None,
        *,
        box: Sequence[tuple[float, float]] | None = None,
        around: np.ndarray | None = None,
        **values: float,
    ) -> Population: ...
    def simulated_attractors(self, problem: Problem, p: float, starts: int) -> list[dict[str, Any]]: ...
    def known(self, problem: Problem, u: np.ndarray, p: float) -> dict[str, Any]: ...
    def border_kind(self, k: int) -> str: ...
    def beyond(self, problem: Problem, point: BorderPoint, k: int) -> list[Seed]: ...
    def dead_end(self, problem: Problem, point: BorderPoint, k: int) -> str: ...
    def homoclinic_text(self, x: np.ndarray, period: float, p: float, values: ParameterSet) -> str: ...
    def rebuilt_by(self, importable: bool) -> str | None: ...
    def described(self) -> dict[str, Any]: ...
    def describe(self) -> dict[str, Any]: ...
