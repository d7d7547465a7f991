"""The kernels of each model's cycles: native ones, or the reference in plain Python and numpy.

`assemble(model)` returns what a continuation calls (`linearise`, `bordered`, `inspect`), what loci against a second parameter need
(`assign`, `flip`, `transpose`), and two entry points of this package's own (`newton`, `examine`); see `contvines.core.table.TableKernels`
for what each takes. Both cores work on the same data and arrays (`orbits.arguments`).
"""

from __future__ import annotations

from functools import cache
from typing import TYPE_CHECKING

from contvines.core.table import TableKernels, native_table
from orbits.flows.native import rearranged
from orbits.machines.base import Model
from orbits.machines.native_stepper import number

if TYPE_CHECKING:
    from orbits.flows.native.reference_kernels import ReferenceKernels


class NativeKernels(TableKernels):
    """Cycles of one model, in the native core."""

    natural = True
    matrix = staticmethod(rearranged.matrix)


@cache
def _assembled(name: str, machine: int | None) -> NativeKernels | ReferenceKernels:
    if machine is not None:
        return NativeKernels(native_table("core_machine_table", machine))
    from orbits.flows.native.reference_kernels import ReferenceKernels
    from orbits.machines.reference.machine import reference

    return ReferenceKernels(reference(name))


def assemble(model: Model) -> NativeKernels | ReferenceKernels:
    """The kernels for `model`, made once per process."""
    return _assembled(model.name, number(model.name))
