"""Families that cost little: circles u^2 + p^2 = radius^2, some of which fail, or lose their worker."""

import os
from dataclasses import dataclass
from pathlib import Path

import numpy as np

import contvines as cv


@dataclass(frozen=True)
class Circles:
    """Circles; a radius above 3 is refused, and the first worker that meets `deadly` is killed by it."""

    folder: str = ""
    deadly: float = -1.0

    def __call__(self, values, near):
        radius = values["radius"]
        if radius > 3.0:
            raise ValueError(f"radius = {radius:g} is more than 3; expected a smaller one")
        if radius == self.deadly:
            flag = Path(self.folder) / "died"
            if not flag.exists():
                flag.touch()
                os._exit(1)
        scale = values.get("scale", 1.0)
        return cv.AlgebraicProblem(
            lambda u, p: u**2 / scale + p**2 - radius**2, [radius * np.sqrt(scale)], 0.0
        )


def size(found):
    """Half the height of the curve, and how many points there are of it."""
    return {
        "size": max(float(np.abs(b.points).max()) for b in found.graph),
        "folds": len(found.graph.of_kind("fold")),
    }
