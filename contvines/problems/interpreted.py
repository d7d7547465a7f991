"""Kernels that are the same whatever the Jacobian is: what is read of a linearisation, and a change of a parameter."""

from __future__ import annotations

from typing import TYPE_CHECKING, Protocol, runtime_checkable

import numpy as np

if TYPE_CHECKING:
    from scipy.sparse import csc_array

    from .callables import CallableProblem
    from .functions import Operator


@runtime_checkable
class Linearised(Protocol):
    """The workspace of problems made of Python callables: F, F_u and F_p."""

    @property
    def residual(self) -> np.ndarray: ...
    @property
    def jacobian(self) -> np.ndarray | csc_array | Operator: ...
    @property
    def derivative(self) -> np.ndarray: ...


def inspect(data: CallableProblem, u: np.ndarray, p: float, work: Linearised, row: np.ndarray) -> None:
    """Raw spectrum of the linearisation, then the margins of problems that have any."""
    spectrum = data.raw_spectrum(work)
    m = 2 * len(spectrum)
    row[:m].view(np.complex128)[:] = spectrum
    if len(row) > m:
        row[m:] = data.margins(u, p)


def not_finite(residual: np.ndarray, jacobian: np.ndarray, derivative: np.ndarray) -> str:
    """A sentence on what is not a finite number, and in which row."""
    names = (
        ("F", residual),
        ("the derivative of F in the unknowns", jacobian),
        ("the one in the parameter", derivative),
    )
    for name, values in names:
        bad = ~np.isfinite(values if values.ndim == 1 else values.sum(axis=1))
        if bad.any():
            return f"{name} is not finite in row {int(np.argmax(bad))}"
    return ""


def assign(data: CallableProblem, other: CallableProblem, value: float) -> None:
    """Give the parameter that varies in ``other`` a value in ``data``, in place."""
    data.values.assign(other.parameter, value)
