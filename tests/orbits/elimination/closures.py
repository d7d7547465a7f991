"""The data of a system without a word, for what asks for its closure alone; its matrix; and what is tested in both cores."""

import numpy as np
import pytest

from contvines.core.library import native
from contvines.core.table import TableKernels, native_table
from orbits.arguments import cycle_data, workspace
from orbits.flows.native.reference_kernels import ReferenceKernels
from orbits.machines.reference.machine import reference


def closed_by(twist):
    """Data of a system whose last node is its first times `twist`."""
    none = np.zeros(0)
    return cycle_data([], [], none, np.zeros((2, 0)), twist, 0.0, 0, 0, none, np.zeros((0, 0)))


def drawn(length, node, seed):
    """A system of random numbers."""
    work, draw = workspace(length, node, 6), np.random.default_rng(seed)
    for part in work[:4]:
        part[...] = draw.normal(size=part.shape)
    return work, draw


def written_out(A, D, closure):
    """Row i is A_i x_i + D_i x_{i+1}, and x_L is x_0 with its entries times `closure`."""
    length, n = A.shape[:2]
    matrix = np.zeros((length, n, length, n))
    for i in range(length):
        matrix[i, :, i] += A[i]
        matrix[i, :, (i + 1) % length] += D[i] * (closure if i + 1 == length else 1.0)
    return matrix.reshape(length * n, length * n)


def turned(node, twist):
    """All entries but the phase times `twist`."""
    return np.array([1.0, *[twist] * (node - 1)])


def kernels_of(core):
    """Elimination and other readings of a system: "reference", or "native" (those of any machine)."""
    if core == "reference":
        return ReferenceKernels(reference("absorber"))
    if not native():
        pytest.skip("no native core")
    return TableKernels(native_table("core_machine_table", 0))


both_cores = pytest.mark.parametrize("core", ["reference", "native"])
