"""Random machines, and options of the atlases that must contain their attractors."""

from __future__ import annotations

from typing import Any

import numpy as np

from orbits import Absorber, Cavity, Coupled

# starts of the independent simulation at each value
STARTS = {"absorber": 1000, "cavity": 1000, "declared": 1000, "coupled": 200}
OPTIONS: dict[str, dict[str, int]] = {  # options of the atlas
    "absorber": {"depth": 1},
    "cavity": {"depth": 1},
    "declared": {"depth": 0, "starts": 64, "values": 8, "scan": 16},
    "coupled": {"depth": 0, "starts": 64, "values": 8},
}


def drawn(kind: str, i: int) -> tuple[Any, str, tuple[float, float]]:
    """Return the i-th machine of a kind, the parameter that varies, and its interval."""
    g = np.random.default_rng(7000 + i)
    both = {"gravity": g.uniform(0.05, 0.5), "mass_ratio": 0.006, "frequency": g.uniform(0.7, 1.4)}
    if kind in ("absorber", "declared"):
        machine = Absorber(restitution=g.uniform(0.3, 0.95), friction=g.uniform(0.02, 0.6), **both)
        return machine, "amplitude", (0.2, 1.3)
    if kind == "cavity":
        r, mu = g.uniform(0.3, 0.95, 2), g.uniform(0.02, 0.6, 2)
        sides = {
            "restitution_left": r[0],
            "restitution_right": r[1],
            "friction_left": mu[0],
            "friction_right": mu[1],
        }
        return Cavity(**sides, slope=g.uniform(-0.3, 0.3), **both), "amplitude", (0.2, 1.3)
    of = {"forcing": g.uniform(1, 4), "damping": g.uniform(0.3, 1.5), "mass_ratio": g.uniform(0.004, 0.02)}
    contacts = {
        "restitution": g.uniform(0.4, 0.9),
        "friction": g.uniform(0.05, 0.6),
        "gravity": g.uniform(0.1, 0.4),
    }
    return Coupled(**of, **contacts), "frequency", (0.97, 1.03)
