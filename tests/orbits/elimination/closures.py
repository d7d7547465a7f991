"""The data of a system without a word, for what asks for its closure alone; and what is tested in both cores."""

import numpy as np
import pytest

from contvines.core.library import native
from contvines.core.table import TableKernels, native_table
from orbits.arguments import cycle_data
from orbits.flows.native.reference_kernels import ReferenceKernels
from orbits.machines.reference.machine import reference


def closed_by(twist):
    """Data of a system whose last node is its first times `twist`."""
    none = np.zeros(0)
    return cycle_data([], [], none, np.zeros((2, 0)), twist, 0.0, 0, 0, none, np.zeros((0, 0)))


def kernels_of(core):
    """Elimination and other readings of a system: "reference", or "native" (those of any machine)."""
    if core == "reference":
        return ReferenceKernels(reference("absorber"))
    if not native():
        pytest.skip("no native core")
    return TableKernels(native_table("core_machine_table", 0))


both_cores = pytest.mark.parametrize("core", ["reference", "native"])
