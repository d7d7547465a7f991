"""A demo problem of another package: its equations as printed there, and the start of its continuation."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from types import SimpleNamespace
from typing import Any

import mpmath as mp
import numpy as np

NUMBERS = SimpleNamespace(
    exp=np.exp, log=np.log, tanh=np.tanh, cosh=np.cosh, cos=np.cos, sin=np.sin, atan=np.arctan, pi=np.pi
)
MANY_DIGITS = SimpleNamespace(
    exp=mp.exp, log=mp.log, tanh=mp.tanh, cosh=mp.cosh, cos=mp.cos, sin=mp.sin, atan=mp.atan, pi=mp.pi
)


@dataclass(frozen=True)
class Demo:
    """A demo.

    Attributes
    ----------
    name : str
    source : str
        Packages that contain it, and its name there.
    equations : callable
        (u, p, m) -> list of numbers; ``m`` has the elementary functions for floats or for many digits.
    u, p : start
        Unknowns and parameter.
    within : (float, float)
        Interval of the parameter.
    parameter : str
        Name of the parameter in the source.
    kind : {"flow", "map"}
    depth : int
    options : dict
        Further arguments of the problem.
    printed : str
        Results that the source or its documentation prints.
    exact : dict
        Kind -> value of special points whose defining equations are singular: branch points with two null vectors.
    """

    name: str
    source: str
    equations: Callable[..., list[Any]]
    u: list[float]
    p: float
    within: tuple[float, float]
    parameter: str = "p"
    kind: str = "flow"
    depth: int = 2
    options: dict[str, Any] = field(default_factory=dict)
    printed: str = ""
    exact: dict[str, float] = field(default_factory=dict)

    def function(self, u: np.ndarray, p: Any) -> np.ndarray:
        """Return the equations as a function for contvines."""
        return np.array(self.equations(u, p, NUMBERS))
