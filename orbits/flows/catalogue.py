"""The flow and the simulator of a machine; those of its sort are imported when a machine asks for them."""

from __future__ import annotations

from functools import cache
from typing import TYPE_CHECKING, TypeVar

import numpy as np

from orbits.flows.protocol import Flow, Simulator

if TYPE_CHECKING:
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
