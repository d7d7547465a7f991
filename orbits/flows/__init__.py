"""The motion between two events, in closed form (`native`) or integrated (`page`: machines declared in a file), behind one protocol.

Functions here make a machine from its settings, and find the flow and the simulator of a machine. Modules of one sort of machines are
imported only when one of them is used.
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache
from typing import TYPE_CHECKING, Any, TypeVar

import numpy as np

from orbits.flows.protocol import Flow, Simulator
from orbits.machines.names import model_class

if TYPE_CHECKING:
    from orbits.flows.protocol import Flow, Simulator
    from orbits.machines.base import Model as BuiltIn
    from orbits.machines.structure import Structure
    from orbits.machines.varying import Varying


Model = TypeVar("Model", bound="Varying")


def flow_of(model: Model) -> Flow[Model]:
    """Return the flow of a machine."""
    return _flow(model.flow)


def simulator_of(model: Varying, params: np.ndarray) -> Simulator:
    """Return a simulator of a machine at these parameters."""
    return _simulator(model.flow)(model, params)


@cache
def _flow(name: str) -> Flow:
    if name == "page":
        from orbits.flows.page.flow import PageFlow

        return PageFlow()
    from orbits.flows.native.flow import NativeFlow

    return NativeFlow()


@cache
def _simulator(name: str) -> type:
    if name == "page":
        from orbits.flows.page.simulator import PageSimulator

        return PageSimulator
    from orbits.flows.native.simulator import NativeSimulator

    return NativeSimulator


def machine_of(settings: Mapping[str, Any]) -> BuiltIn | Structure:
    """Return the machine with these settings, `name` among them (see `Model.settings`)."""
    if "structure" in settings:
        from orbits.machines.structure import structure_again

        return structure_again(settings)
    if settings.get("units"):
        from orbits.machines.physical.machine import physical_again

        return physical_again(settings)
    values = {key: value for key, value in settings.items() if key not in ("name", "units")}
    return model_class(str(settings["name"]))(**values)
