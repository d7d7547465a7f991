"""What happens between two events: one protocol, fulfilled by closed forms (`native`) and by pages (`page`).

A machine from its settings, its flow and its simulator; what belongs to one sort of machines is imported when one of it is asked for.
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
    """The flow of a machine."""
    return _flow(model.flow)


def simulator_of(model: Varying, params: np.ndarray) -> Simulator:
    """The simulator of a machine at these parameters."""
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
    """The machine with these settings, `name` among them (see `Model.settings`)."""
    if "structure" in settings:
        from orbits.machines.structure import structure_again

        return structure_again(settings)
    if settings.get("units"):
        from orbits.machines.physical.machine import physical_again

        return physical_again(settings)
    values = {key: value for key, value in settings.items() if key not in ("name", "units")}
    return model_class(str(settings["name"]))(**values)
