"""PlanePoint: a point of codimension two, with its evidence."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

from ..bifurcation.critical import critical
from ..shared.number_text import pairs

if TYPE_CHECKING:
    from ..problems.protocol import Problem


@dataclass(eq=False)
class PlanePoint:
    """A point of codimension two.

    Attributes
    ----------
    label, kind : str
    parameters : (str, str)
    value : (float, float)
    u : ndarray, shape (N,)
        The motion, in the unknowns of ``problem``.
    on : list of str
        Labels of the loci on which it lies.
    coefficients : dict
        Of its normal form; see :mod:`contvines.bifurcation.normal_forms.coefficients`.
    multipliers : ndarray of complex
        Of the full period.
    real : bool
    error : float
        Of both values, relative: the last correction of Newton's method, of cycles on a mesh also what the mesh leaves.
    residual : float
    margins : tuple of int
        Places of the margins that vanish there.
    note : str
    problem : Problem or None
    """

    label: str
    kind: str
    parameters: tuple[str, str]
    value: tuple[float, float]
    u: np.ndarray = field(repr=False)
    on: list[str] = field(default_factory=list)
    coefficients: dict[str, float] = field(default_factory=dict)
    multipliers: np.ndarray = field(default_factory=lambda: np.zeros(0, complex), repr=False)
    real: bool = True
    error: float = 0.0
    residual: float = 0.0
    margins: tuple[int, ...] = ()
    note: str = ""
    problem: Problem | None = field(default=None, repr=False)

    @property
    def attached(self) -> Problem:
        """The problem.

        Raises
        ------
        ValueError
            If the point was loaded without it.
        """
        if self.problem is None:
            raise ValueError(f"{self.label} was loaded without its problem")
        return self.problem

    @property
    def orbit(self) -> object:
        """The motion as the object that its problem hands to users; see :attr:`contvines.SpecialPoint.orbit`."""
        return critical(self.attached.orbit(self.u, self.value[0]), self.kind)

    def to_dict(self) -> dict[str, Any]:
        """The entry of this point in the JSON of a chart."""
        return {
            "label": self.label,
            "kind": self.kind,
            "value": dict(zip(self.parameters, map(float, self.value))),
            "on": list(self.on),
            "coefficients": {name: float(value) for name, value in self.coefficients.items()},
            "real": bool(self.real),
            "multipliers": pairs(self.multipliers),
            "error": float(self.error),
            "residual": float(self.residual),
            "note": self.note,
        }
