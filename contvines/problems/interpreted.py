"""Kernels that are the same whatever the Jacobian is: what is read of a linearisation, and a change of a parameter."""

from __future__ import annotations

from typing import TYPE_CHECKING, Protocol, runtime_checkable

import numpy as np

if TYPE_CHECKING:
    from scipy.sparse import csc_array

    from .functions import Operator
    from .parameters import ParameterSet
    from .scales import Scales


@runtime_checkable
class Linearised(Protocol):
    """The workspace of problems made of Python callables: F, F_u and F_p."""

    @property
    def residual(self) -> np.ndarray: ...
    @property
    def jacobian(self) -> np.ndarray | csc_array | Operator: ...
    @property
    def derivative(self) -> np.ndarray: ...


class Equations(Protocol):
    """What the kernels read of a problem made of Python callables, their `data`."""

    values: ParameterSet
    scales: Scales | None
    reference: np.ndarray | csc_array | None
    trouble: str
    unsolved: bool

    @property
    def parameter(self) -> str: ...
    @property
    def side(self) -> np.ndarray: ...
    def preconditioner_at(self) -> np.ndarray | Operator | None: ...
    def equations(
        self, u: np.ndarray, p: float
    ) -> tuple[np.ndarray, np.ndarray | csc_array | Operator, np.ndarray]: ...
    def sizes(self) -> tuple[np.ndarray, np.ndarray]: ...
    def raw_spectrum(self, work: Linearised) -> np.ndarray: ...
    def margins(self, u: np.ndarray, p: float) -> np.ndarray: ...


def inspect(data: Equations, u: np.ndarray, p: float, work: Linearised, row: np.ndarray) -> None:
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


def assign(data: Equations, other: Equations, value: float) -> None:
    """Give the parameter that varies in ``other`` a value in ``data``, in place."""
    data.values.assign(other.parameter, value)
