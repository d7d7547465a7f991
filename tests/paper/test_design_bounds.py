"""Design bounds of drawn machines against continuation of their orbits: fold and symmetry breaking, in
metres."""

from __future__ import annotations

import numpy as np
import pytest

import contvines as cv
from orbits import Absorber
from orbits.design import Design

pytestmark = pytest.mark.slow


@pytest.mark.parametrize("seed", range(4))
def test_bounds_are_the_special_points_of_the_branch(seed):
    rng = np.random.default_rng(seed)
    values = {
        "restitution": rng.uniform(0.45, 0.9), "friction": rng.uniform(0.05, 0.6), "gravity": rng.uniform(0.05, 0.35),
        "mass_ratio": rng.uniform(0.002, 0.05),
    }  # fmt: skip
    design = Design.from_dimensionless(**{**values, "cavity": 0.015})
    low, high = float(design.activation_threshold) / 0.015, float(design.upper_bound) / 0.015
    start = Absorber(**values).symmetric_orbit(0.5 * (low + high))
    graph = cv.diagram(start, over="amplitude", within=(0.5 * low, 1.05 * high), depth=0)
    found = {s.kind: s.value for s in graph.special.values() if s.kind in ("fold", "symmetry-breaking")}
    assert found["fold"] == pytest.approx(low, rel=1e-9)
    assert found["symmetry-breaking"] == pytest.approx(high, rel=1e-9)
    assert design.operating_ratio == pytest.approx(found["symmetry-breaking"] / found["fold"], rel=1e-9)
