"""Limits: where branches end because the user says so."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from ..problems.protocol import Problem


@dataclass(frozen=True)
class Limits:
    """Functions at whose zeros branches end, and the bounds that some of them stand for.

    Attributes
    ----------
    functions : dict
        name -> callable (u, p) -> float, or (measure, value).
    bounds : dict
        name of a measure -> (low, high).
    """

    functions: dict[str, Any] = field(default_factory=dict)
    bounds: dict[str, tuple[float, float]] = field(default_factory=dict)

    @classmethod
    def of(
        cls,
        stop: Mapping[str, Any] | None,
        bounds: Mapping[str, tuple[float, float]] | None,
        problem: Problem,
    ) -> Limits:
        """From what a user gives.

        Parameters
        ----------
        stop : mapping, optional
            name -> callable (u, p) -> float, or (measure, value).
        bounds : mapping, optional
            measure -> (low, high); either may be infinite or None.
        problem : Problem
            Its measures may have bounds.

        Raises
        ------
        ValueError
            If a bound is no pair of numbers, the first one smaller, or there is no such measure.
        """
        functions, pairs = dict(stop or {}), {}
        for name, pair in (bounds or {}).items():
            known = problem.measure_names
            if name not in known:
                raise ValueError(f"bounds: there is no measure {name!r}; choose from {', '.join(known)}")
            try:
                low, high = (
                    float(default if value is None else value)
                    for value, default in zip(pair, (-math.inf, math.inf), strict=True)
                )
            except (TypeError, ValueError):
                raise ValueError(
                    f"bounds: {name!r} has {pair!r}; give two numbers, low and high (None where there is no bound)"
                ) from None
            if not low < high:
                raise ValueError(
                    f"bounds: {name!r} has [{low:g}, {high:g}]; the first one must be the smaller one"
                )
            pairs[name] = (low, high)
            functions |= {f"{name} = {end:g}": (name, end) for end in (low, high) if math.isfinite(end)}
        return cls(functions, pairs)

    def kept(self) -> dict[str, Any]:
        """What a graph keeps of them among its settings, JSON-able: the bounds."""
        pairs = {
            name: [end if math.isfinite(end) else None for end in pair] for name, pair in self.bounds.items()
        }
        return {"bounds": pairs} if pairs else {}

    def outside(self, problem: Problem, u: np.ndarray, p: float) -> str:
        """A sentence on the first bound beyond which a solution lies; empty if it lies within all."""
        for name, (low, high) in self.bounds.items():
            value = float(problem.measures((name,), np.atleast_2d(u), np.array([p]))[name][0])
            if not low <= value <= high:
                return f"{name} = {value:.6g} is outside of its bounds [{low:g}, {high:g}]"
        return ""


NO_LIMITS = Limits()
