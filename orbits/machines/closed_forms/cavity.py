"""The ball that bounces off one wall of an inclined cavity without friction, in closed form."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import numpy as np

from orbits.words import Word


def start_nodes(word: Word, periods: int, value: Mapping[str, float]) -> Iterator[np.ndarray]:
    """Nodes of the bounce off one wall on a slope without friction, `R` (or `L` for a negative slope).

    Over k forcing periods, T = 2 pi k/Omega: B+ = -b T/2 and C Omega cos Psi = -(1 - r)/(1 + r) b T/2.
    """
    if not word.frictionless or word.events not in (("R",), ("L",)):
        return
    b = (1.0 + value["mass_ratio"]) * value["gravity"] * np.sin(value["slope"])
    r = value["restitution_right" if word.events == ("R",) else "restitution_left"]
    half, speed = np.pi * periods / value["frequency"], value["amplitude"] * value["frequency"]
    cosine = -(1.0 - r) / (1.0 + r) * b * half
    if (b > 0.0) != (word.events == ("R",)) or abs(cosine) > speed:
        return
    for sign in (-np.sign(b), np.sign(b)):  # where the table brakes the more the later it is hit: stable
        yield np.array([[sign * np.arccos(cosine / speed) % (2.0 * np.pi), -b * half]])
