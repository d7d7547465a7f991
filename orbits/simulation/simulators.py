"""The simulator of a machine."""

from __future__ import annotations

from typing import Any

import numpy as np

from orbits.simulation.native import NativeSimulator
from orbits.simulation.page import PageSimulator


def simulator_of(model: Any, params: np.ndarray) -> Any:
    """The simulator of a machine at these parameters; the contract is at the top of `orbits.flows.protocol`."""
    return PageSimulator(model, params) if model.flow == "page" else NativeSimulator(model, params)
