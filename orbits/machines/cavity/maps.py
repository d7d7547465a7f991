"""Elementary maps and margins of a cavity: `orbits.machines.cavity.equations` with its numbers."""

from __future__ import annotations

from orbits.machines.cavity.equations import cycle
from orbits.machines.cavity.equations import unpin as unpin
from orbits.machines.cavity.margins import watch
from orbits.machines.cavity.numbers import law, rate
from orbits.machines.path import place


def linearise(data, u, p, work):
    """Residuals and derivatives at the cycle `u`; see `orbits.machines.cavity.equations.cycle`."""
    par = work.numbers
    place(data.params, data.path, p, par)
    return cycle(data, u, work, law(par), rate(par, par[data.params.shape[0] :]))


def margins(data, u, p, work, out):
    """Margins of admissibility; see `orbits.machines.cavity.margins.watch`."""
    watch(data, u, work, law(work.numbers), out)
