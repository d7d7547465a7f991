"""Newton's method in plain Python gives up in time, on an equation that anybody can solve."""

import math
from types import SimpleNamespace

import numpy as np
import pytest

from orbits.flows.page.cycle_equations import PageKernels


class Square(PageKernels):
    """u^2 = a, its residual known to `noise` only."""

    def __init__(self, a: float, noise: float = 0.0) -> None:
        self.a, self.noise, self.calls = a, noise, 0

    def linearise(self, data, u, p, work):
        self.calls += 1
        work.u = float(u[0])
        work.residual = work.u**2 - self.a + self.noise * (-1) ** self.calls
        return abs(work.residual)

    def bordered(self, data, work, border, target, step, tangent):
        step[:] = -work.residual / (2.0 * work.u), 0.0
        return 1.0


def solved(kernels, limit=40):
    u, border = np.array([3.0]), np.array([0.0, 1.0])
    found = kernels.newton(None, u, 0.0, SimpleNamespace(), border, np.empty(2), np.empty(2), 1e-13, limit)
    return u[0], found[0]


def test_a_root_known_to_roundoff_is_found_in_a_few_steps():
    kernels = Square(2.0, 1e-11)
    u, residual = solved(kernels)
    assert u == pytest.approx(math.sqrt(2.0), abs=2e-11) and residual < 1e-10 and kernels.calls < 15


def test_without_a_root_it_gives_up_before_the_limit():
    kernels = Square(-1.0)
    assert solved(kernels)[1] == math.inf and kernels.calls < 60
