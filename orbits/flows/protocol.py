"""What a flow, the motion between two events, is asked about."""

from __future__ import annotations

from typing import Any, Protocol

import numpy as np


class Motion(Protocol):
    """What a flow is asked about: word, nodes and parameters of a cycle (`orbits.cycles.cycle.Cycle`)."""

    @property
    def model(self) -> Any: ...
    @property
    def word(self) -> Any: ...
    @property
    def periods(self) -> int: ...
    @property
    def nodes(self) -> np.ndarray: ...
    @property
    def params(self) -> np.ndarray: ...
    @property
    def parameters(self) -> dict[str, float]: ...
    @property
    def durations(self) -> np.ndarray: ...
