"""What machines with a harmonically shaken cavity have in common."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from orbits.machines.base import Model
from orbits.words import Word


class Shaken(Model):
    """A machine whose cavity moves as v = C sin(Omega tau), whatever the absorber does."""

    node_names = ("phase", "B or w")
    default_parameter = "amplitude"
    driven_by = "amplitude"

    def natural_units(self, params: np.ndarray) -> tuple[float, float]:
        left, right = self.walls(params)
        length, rate = (
            float(min(left, -right)),
            float(self.column(params, "frequency")),
        )  # a far wall may be out of reach
        return length if 0.0 < length < math.inf else 1.0, rate if 0.0 < rate < math.inf else 1.0

    @classmethod
    def cavity_motion(cls, nodes: np.ndarray, params: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        amplitude, omega = cls.column(params, "amplitude")[:, None], cls.column(params, "frequency")[:, None]
        phase = nodes[:, :, 0]
        return amplitude * np.sin(phase), amplitude * omega * np.cos(phase)

    @classmethod
    def cavity_speed(cls, node: np.ndarray, params: np.ndarray) -> tuple[float, np.ndarray]:
        speed, phase = (
            float(cls.column(params, "amplitude") * cls.column(params, "frequency")),
            float(node[0]),
        )
        return speed * math.cos(phase), np.array([-speed * math.sin(phase), 0.0])

    def measure_own(
        self, wanted: Sequence[str], word: Word, periods: int, nodes: np.ndarray, params: np.ndarray
    ) -> dict[str, np.ndarray]:
        return {name: self.column(params, "amplitude") ** 2 for name in wanted}

    def random_nodes(
        self, word: Word, periods: int, params: np.ndarray, generator: np.random.Generator
    ) -> np.ndarray | None:
        amplitude, omega = float(self.column(params, "amplitude")), float(self.column(params, "frequency"))
        phases = np.sort(generator.uniform(0.0, 2.0 * np.pi * periods, len(word)))
        second = generator.uniform(-0.9, 0.9, len(word))
        for i, letter in enumerate(word.events):
            if letter in "LR":
                sign = 1.0 if letter == "L" else -1.0
                second[i] = sign * generator.uniform(0.0, 1.5) * (1.0 + amplitude) * omega
        return np.column_stack([phases, second])
