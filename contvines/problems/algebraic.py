"""AlgebraicProblem: F(u, p) = 0 from a Python callable."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from copy import copy
from typing import Any

import numpy as np

from .dense import KERNELS, DenseWork, dense_workspace
from .derivatives import Differentiated
from .images import image_map
from .parameters import ParameterSet
from .protocol import ProblemDefaults, Symmetry
from .registry import find_callables


class AlgebraicProblem(ProblemDefaults):
    """Solutions of F(u, p) = 0, or equilibria of u' = F(u, p).

    Parameters
    ----------
    F : callable
        (u of shape (N,), p) -> N numbers.
    u0 : array_like, shape (N,) or scalar
        A start; it need not be exact.
    p0 : float, or mapping of str to float
        Parameter value of the start, or the values of several parameters by name: ``F(u, p)`` then reads ``p.name``.
    parameter : str
        Name of the parameter that varies; of several the first one, if it is left out.
    jacobian : callable, optional
        (u, p) -> dF/du of shape (N, N). Else the complex step, where F allows it, or sixth-order differences.
    derivative : callable, or mapping of str to callable, optional
        (u, p) -> dF/dp of shape (N,); of several parameters by name.
    spectrum : {"none", "flow"}
        "flow": stability and Hopf points from the eigenvalues of dF/du.
    mirror : callable, matrix or permutation, optional
        u -> image of u that solves the same equations; branch points on its fixed space are symmetry breakings and one
        of the two mirror images is traced.
    name : str, optional
        For tables.

    Raises
    ------
    ValueError
        If F does not return N finite numbers at the start.
    """

    def __init__(
        self,
        F: Callable,
        u0: Sequence[float] | np.ndarray | float,
        p0: float | Mapping[str, float] = 0.0,
        parameter: str = "p",
        jacobian: Callable | None = None,
        derivative: Callable | Mapping[str, Callable] | None = None,
        spectrum: str = "none",
        mirror: Any = None,
        name: str = "algebraic",
    ) -> None:
        if spectrum not in ("none", "flow"):
            raise ValueError(f'spectrum = {spectrum!r} must be "none" or "flow"; for maps use MapProblem')
        self.u0 = np.array(u0, dtype=float).reshape(-1)
        self.values = ParameterSet(p0, parameter)
        self.spectrum, self.name = spectrum, name
        self.dimension = len(self.u0)
        self.n_multipliers = self.dimension if spectrum == "flow" else 0
        value = np.asarray(F(self.u0.copy(), self.values.at(self.p0)), dtype=float).reshape(-1)
        if len(value) != self.dimension:
            raise ValueError(
                f"F returns {len(value)} numbers for {self.dimension} unknowns; as many are needed"
            )
        if not np.all(np.isfinite(value)):
            raise ValueError(f"F is not finite at the start u0 = {self.u0}, {self.parameter} = {self.p0}")
        self.functions = Differentiated(F, jacobian, derivative, self.u0, self.values)
        self.given_mirror = mirror
        self.mirror = None if mirror is None else image_map(mirror, self.dimension)
        if self.mirror is not None:
            self.symmetries = (Symmetry("symmetry-breaking", self.mirror),)
        self.kernels = KERNELS
        self.data = self
        self.describe()  # its callables are known by their addresses from now on

    @property
    def parameter(self) -> str:
        """Name of the parameter that varies."""
        return self.values.varying

    @property
    def parameters(self) -> dict[str, float]:
        """All parameters by name; of the one that varies the value at the start."""
        return dict(self.values.values)

    @property
    def p0(self) -> float:
        """Value of the varying parameter at the start."""
        return self.values.start

    def against(self, parameter: str, values: Mapping[str, float] | None = None) -> AlgebraicProblem:
        """The same equations with another parameter varying, and with other values of some parameters.

        Cheap: nothing is evaluated.
        """
        other = copy(self)
        other.values = self.values.against(parameter, values)
        other.functions = self.functions.against(other.values)
        other.data = other
        return other

    def workspace(self) -> DenseWork:
        """Arrays for the kernels."""
        return dense_workspace(self.dimension)

    def equations(self, u: np.ndarray, p: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """F, dF/du, dF/dp."""
        return self.functions.value(u, p), self.functions.jacobian(u, p), self.functions.derivative(u, p)

    def raw_spectrum(self, work: DenseWork) -> np.ndarray:
        """Eigenvalues of dF/du (none for spectrum "none")."""
        return np.linalg.eigvals(work.jacobian) if self.n_multipliers else np.zeros(0)

    def canonical(self, u: np.ndarray, p: float) -> tuple[Any, np.ndarray]:
        """Of u and its mirror image the one that comes first in dictionary order."""
        u = np.asarray(u, dtype=float)
        if self.mirror is not None:
            image = self.mirror(u)
            different = np.flatnonzero(np.abs(image - u) > 1e-7 * (1.0 + np.abs(u)))
            if len(different) and image[different[0]] < u[different[0]]:
                u = image
        return ("algebraic", self.dimension), u

    def describe(self) -> dict[str, Any]:
        """Name, start, and how to build the problem again if F can be imported."""
        where, importable = self.functions.addresses(mirror=self.given_mirror)
        return {
            "name": self.name,
            "parameter": self.parameter,
            "spectrum": self.spectrum,
            "u0": self.u0.tolist(),
            "p0": self.values.given(),
            "callables": where,
            "factory": "contvines.problems.algebraic:from_description" if importable else None,
        }


def from_description(description: Mapping[str, Any], trust: bool = False) -> AlgebraicProblem | None:
    """An AlgebraicProblem from what ``describe()`` returned; None where its callables are not at hand."""
    functions = find_callables(description["callables"], trust)
    if functions is None:
        return None
    F = functions.pop("F")
    return AlgebraicProblem(
        F,
        description["u0"],
        description["p0"],
        parameter=description["parameter"],
        spectrum=description["spectrum"],
        name=description["name"],
        **functions,
    )
