"""Machines of one to three bodies drawn at random: simulation and orbits against an integration of Newton's laws that shares no code."""

import numpy as np
import pytest

from tools.machine_files import compared, draw, machine, orbits_of, returning

# 12: impacts pile up beside friction; 33: a damper hands on a blow to a body that sticks; 131: a wall that moves holds a body on a belt
SEEDS = (0, 12, 33, 131)


@pytest.mark.slow
@pytest.mark.parametrize("seed", SEEDS)
def test_motions_and_orbits(seed: int) -> None:
    drawn, rng = draw(1, seed), np.random.default_rng(seed)
    declared = machine(drawn)
    assert [said for said in (compared(drawn, declared, rng) for _ in range(3)) if said] == []
    assert [said for said in (returning(drawn, orbit) for orbit in orbits_of(declared, rng)) if said] == []
