"""FlowFamily: the flow of a Python file with many values of its parameters, for surveys."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from .files import load_flow

if TYPE_CHECKING:
    from .equilibria import Equilibria
    from .orbit import CycleOrbit


@dataclass(frozen=True)
class FlowFamily:
    """A flow of a file; the file is run in each worker process.

    Attributes
    ----------
    file, name : str
        The Python file and the flow in it.
    parameter : str
        Which varies along each diagram.
    values : mapping of str to float
        Of the parameters that do not vary from system to system.
    state : sequence of float, optional
        Diagrams begin with the cycle on which a motion from there settles; else, of flows that are not forced, with an equilibrium.
    box : sequence of (low, high), optional
        Ranges of the states from which simulations begin.
    """

    file: str
    name: str
    parameter: str
    values: Mapping[str, float]
    state: Sequence[float] | None = None
    box: Sequence[tuple[float, float]] | None = None

    def __call__(self, values: Mapping[str, float], near: object = None) -> CycleOrbit | Equilibria:
        """The start of a system's diagram.

        Raises
        ------
        ValueError
            If there is none, or the file has no such flow any more.
        """
        flow = load_flow(self.file, self.name)
        numbers: dict[str, Any] = {**self.values, **values}
        if flow is None:
            raise ValueError(f"{self.file} has no flow {self.name!r} any more")
        flow.box = self.box
        if self.state is not None or flow.field.forced:
            return flow.attractor_at(numbers, self.state)
        return flow.equilibria(self.parameter, numbers)
