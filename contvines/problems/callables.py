"""CallableProblem: base class of problems made of Python callables, with their parameters, scales, checks and messages."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Hashable, Mapping, Sequence
from copy import copy
from typing import TYPE_CHECKING, Any, Self

import numpy as np

from contvines.shared.near_names import did_you_mean
from contvines.shared.numbers import ROUNDED

from . import dense
from .checks import disagreement, empty_row, find_break
from .derivatives import Differentiated
from .functions import NotEvaluable, Operator, ParameterSet, Parametrised
from .pieces import Pieced, Pieces
from .protocol import ProblemDefaults
from .scales import Scales
from .settings import DERIVATIVES
from .spectra import side
from .symmetries import refuse_asymmetry

if TYPE_CHECKING:
    from types import ModuleType

    from scipy.sparse import csc_array

    from .dense import DenseWork
    from .large.sparse import SparseWork
    from .protocol import BorderPoint, Kernels, Seed
    from .symmetries import Image

TERMS = 62  # unknowns whose rounding errors are summed in the uncertainty; those of more cancel


class CallableProblem(Parametrised, ProblemDefaults, ABC):
    """A problem whose equations are Python callables.

    Attributes
    ----------
    values : ParameterSet
    functions : Differentiated
    u0 : ndarray
        The start.
    given_scale : ndarray or None
        Scale of each unknown, as far as the user has given it.
    scales : Scales or None
        None until they have been learned.
    reference
        Matrix relative to which the eigenvalues of F_u are computed for branch points if there is no spectrum.
    many : bool
        Whether these eigenvalues are computed only near branch points, as a cheaper number decides; see :mod:`.spectra`.
    close : bool
        Whether this copy computes them; see `closer`.
    signed : bool
        Whether the sign of the determinant is known: not for a matrix-free Jacobian.
    trouble : str
        Reason of the last failed evaluation of the equations.
    unsolved : bool
        Whether GMRES failed at the last linear system (matrix-free Jacobian).
    generators, symmetric_for, mixed_rows
        Symmetries as pairs (name, image); the parameter sets for which they have been checked; whether their check allows the rows
        of F to be permuted and multiplied. See :mod:`.symmetries`.
    """

    values: ParameterSet
    functions: Differentiated
    u0: np.ndarray
    given_scale: np.ndarray | None = None
    scales: Scales | None = None
    reference: np.ndarray | csc_array | None = None
    many = False
    close = False
    trouble = ""
    unsolved = False
    _side: tuple[Scales | None, np.ndarray] | None = None

    given: dict[str, Any]
    pieces: Pieces
    generators: Sequence[tuple[str, Image]] = ()
    symmetric_for: set[tuple[Hashable, ...]]
    mixed_rows = False

    def _wrapped(
        self, pieces: Pieces
    ) -> tuple[Callable, Callable | None, Callable | Mapping[str, Callable] | None]:
        """Return F, the given Jacobian and the given parameter derivative, with the signs of `pieces` filled in.

        Raises
        ------
        ValueError
            If one of them is no function.
        """
        for key in ("F", "jacobian", "derivative"):
            given = self.given[key]
            several = key == "derivative" and isinstance(given, Mapping)
            for name, f in given.items() if several else [("", given)]:
                place = f"{key}[{name!r}]" if several else key
                if several and name not in self.parameters:
                    hint = did_you_mean(str(name), self.parameters)
                    raise ValueError(
                        f"{place}: there is no parameter of this name{hint}; the problem has {', '.join(self.parameters)}"
                    )
                if not callable(f) and (f is not None or key == "F"):
                    text = f"a {type(f).__name__}" if hasattr(f, "shape") or isinstance(f, list) else repr(f)
                    raise ValueError(f"{place} = {text} must be a function of (u, p)")
        jacobian, derivative = self.given["jacobian"], self.given["derivative"]
        if isinstance(derivative, Mapping):
            slopes = {name: pieces.wrap(f, "derivative") for name, f in derivative.items()}
        else:
            slopes = None if derivative is None else pieces.wrap(derivative, "derivative")
        wrapped = None if jacobian is None else pieces.wrap(jacobian, "jacobian")
        return pieces.wrap(self.given["F"], "F"), wrapped, slopes

    def functions_in(self, pieces: Pieces) -> Differentiated:
        """Return the equations and their derivatives with other signs of the switches."""
        return self.functions.of(*self._wrapped(pieces))

    def closer(self) -> Self:
        """Return the same problem, with the eigenvalues nearest to zero in its rows; see :mod:`.spectra`."""
        problem = copy(self)
        problem.data, problem.close = problem, True
        return problem

    # ------------------------------------------------------------------ parameters
    def against(self, parameter: str, values: Mapping[str, float] | None = None) -> Self:
        """Return the same problem with another parameter varying, and with other values of some parameters.

        Nothing is evaluated. If another parameter varies, the scales are learned again.

        Parameters
        ----------
        parameter : str
            Name of the parameter that varies in the new problem.
        values : mapping, optional
            New values of some parameters.

        Raises
        ------
        ValueError
            If a name is not among the parameters.
        """
        other = copy(self)
        other.values = self.values.against(parameter, values)
        other.functions = self.functions.against(other.values)
        if self.pieces.count:
            other.pieces = self.pieces.against(other.values)
            other.functions = other.functions.of(*other._wrapped(other.pieces))
        if parameter != self.parameter:
            other.scales = other.reference = None
        return other._rebind()

    def _rebind(self) -> Self:
        """Let a copy's references to the problem refer to the copy; every method that copies calls it."""
        self.data = self
        return self

    # ------------------------------------------------------------------ the equations
    @abstractmethod
    def residuals(self, u: np.ndarray, p: float) -> np.ndarray:
        """Return F without its derivatives."""

    def margins(self, u: np.ndarray, p: float) -> np.ndarray:
        """Return the switches times their signs: positive while the solution lies in its piece."""
        nodes = np.asarray(u)[: self.node * len(self.pieces.signs)].reshape(-1, self.node)
        return self.pieces.margins(nodes, p)

    def margin_kind(self, j: int) -> str:
        """Kind of the border at which margin j vanishes: always "switch"."""
        return "switch"

    def beyond(self, point: BorderPoint) -> list[Seed]:
        """Return the solutions on the other side of a switch."""
        return self.pieces.beyond(self, point)

    @abstractmethod
    def with_pieces(self, pieces: Pieces) -> Pieced:
        """Return the same problem with other signs of the switches."""

    # ------------------------------------------------------------------ scales
    node: int

    def amplitude(self, direction: np.ndarray) -> float:
        """Length of a direction for normal forms: the Euclidean norm over the unknowns (of a cycle: over its first point)."""
        return float(np.linalg.norm(direction[: self.node]))

    def of_unknowns(self, each: np.ndarray) -> np.ndarray:
        """Extend an array over the arguments of the user's function to all unknowns of the problem."""
        return each

    @property
    def lengths(self) -> np.ndarray:
        """Change of each unknown over which the equations are nonlinear, shape (N,)."""
        return self.of_unknowns(self.functions.lengths)

    @property
    def noise(self) -> float:
        """Error of the unknowns that noise of the equations causes, relative to their scale; 0: roundoff only."""
        return 0.0 if self.scales is None else self.scales.noise

    @property
    def scales_learned(self) -> bool:
        """Whether the scales of the unknowns were learned near the start, not given by the user."""
        return self.scales is not None and self.given_scale is None

    def scale_within(self, within: tuple[float, float]) -> np.ndarray:
        """Typical sizes of unknowns and parameter, shape (N + 1,); the first call learns them."""
        scales = self.scales
        self._check_symmetries()
        if scales is None:
            from .scouting import learn

            scales = self.scales = learn(self, within, self.given_scale)
        return scales.vector

    def sizes(self) -> tuple[np.ndarray, np.ndarray]:
        """Typical sizes of equations and unknowns; ones before the scales are learned."""
        scales = self.scales
        if scales is None:
            return np.ones(self.dimension), np.ones(self.dimension)
        return scales.rows, scales.unknowns

    @property
    def side(self) -> np.ndarray:
        """Fixed right-hand side b of the distance from a branch point, shape (N + 1,); see :mod:`.spectra`."""
        if self._side is None or self._side[0] is not self.scales:
            self._side = self.scales, side(self.sizes()[0])
        return self._side[1]

    def rates(self, work: DenseWork | SparseWork) -> list[float]:
        """Return typical magnitudes of the eigenvalues of dF/du, if the problem has a spectrum and they are cheap."""
        return []

    # ------------------------------------------------------------------ algebra
    @property
    def algebra(self) -> ModuleType:
        """Module with the kernels for the structure of the Jacobian."""
        if self.functions.structure == "dense":
            return dense
        from .large import sparse

        return sparse

    @property
    def kernels(self) -> Kernels:
        """Kernels for the structure of the Jacobian: dense, sparse, or matrix-free."""
        return self.algebra.KERNELS

    def workspace(self) -> DenseWork | SparseWork:
        """Return new arrays for the kernels."""
        return self.algebra.workspace(self)

    # ------------------------------------------------------------------ errors and messages
    @property
    def stuck(self) -> str:
        """Message if GMRES failed at the last linear system; else empty."""
        if not self.unsolved:
            return ""
        better = "a preconditioner=" if self.given["preconditioner"] is None else "a better preconditioner="
        return f"GMRES does not solve the linear systems of the matrix-free Jacobian; {better} would help"

    @property
    def signed(self) -> bool:
        """Whether the sign of the determinant is known."""
        return self.functions.structure != "operator"

    def uncertainty(self) -> float:
        """Relative accuracy of the last evaluation: the largest error of differences, noise and rounding."""
        errors, least = (
            self.functions.errors,
            max(self.noise, 0.5 * ROUNDED * (2 + min(self.dimension, TERMS))),
        )
        if self.scales is None or not errors.any():
            return least
        scale = self.scales.unknowns[: len(errors)]
        return max(float((errors * scale).max() / self.scales.rows.max()), least)

    def doubts(self, work: DenseWork | SparseWork, rounding: float) -> np.ndarray | csc_array | None:
        """Return bounds of the errors of the entries of (F_u, F_p), shape (N, N + 1): rounding, and the errors of differences.

        Sparse if F_u is sparse; None if F_u is matrix-free.
        """
        matrix = work.jacobian
        if isinstance(matrix, Operator):
            return None
        n, rows = self.dimension, self.sizes()[0]
        errors = np.resize(self.functions.errors, n)
        if not isinstance(matrix, np.ndarray):
            from scipy.sparse import csc_array, diags_array, hstack

            inner = rounding * abs(matrix)
            if errors.any():
                ones = (inner != 0.0).astype(float)
                inner = inner + diags_array(rows / rows.max()) @ ones @ diags_array(errors)
            return csc_array(hstack([inner, rounding * csc_array(np.abs(work.derivative)[:, None])]))
        found = rounding * np.abs(np.column_stack([matrix, work.derivative]))
        found[:, :n] += rows[:, None] / rows.max() * errors
        return found

    def explain_end(self, u: np.ndarray, p: float, tangent: np.ndarray, evaluable: bool) -> str:
        """Return the reason why Newton's method fails at the end of a branch; empty if it cannot be determined.

        Parameters
        ----------
        u, p, tangent
            The last point, and the unit tangent in the direction of the trace.
        evaluable : bool
            False if the equations could not be evaluated at the next point.
        """
        if not evaluable:
            return self.trouble
        for beyond in (0.0, DERIVATIVES.tested_at):
            wrong = self.check(u + beyond * tangent[:-1], p + beyond * float(tangent[-1]))
            if wrong is not None:
                return wrong
        if self.unsolved:
            return self.stuck
        rows = np.ones(self.dimension) if self.scales is None else self.scales.rows

        def line(t: float) -> np.ndarray:
            try:
                return self.residuals(u + t * tangent[:-1], p + t * float(tangent[-1]))
            except NotEvaluable:
                return np.full(self.dimension, np.nan)

        for reach in (0.05, 0.002):
            with np.errstate(all="ignore"):
                noise = np.zeros(self.dimension)
                noise[:] = np.resize(self.functions.noise, self.dimension)
                found = find_break(line, reach, rows, noise)
            if found is not None:
                value = p + found.at * float(tangent[-1])
                place = f"near {self.parameter} = {value:.6g} (row {found.row})"
                if found.kind == "jump":
                    return f"the equations jump {place}"
                return f"the equations have a kink {place}; switches= would select their pieces"
        if self.noise > DERIVATIVES.noticed:
            j = int(np.argmax(self.functions.noise))
            return (
                f"{self.functions.name} has noise of {self.functions.noise[j]:.1g} in row {j}, which moves the solution by "
                f"{self.noise:.1g} of its size{' or more' if self.noise >= DERIVATIVES.largest else ''}: it may be too much for a branch to be followed"
            )
        return ""

    def check(self, u: np.ndarray, p: float) -> str | None:
        """Compare given derivatives with differences of the equations at a solution: a sentence if they disagree, else None."""
        scales = self.scales
        if scales is not None and not len(u) == len(scales.unknowns) == len(self.functions.lengths):
            scales = None
        try:
            return disagreement(self.functions, u, p, scales)
        except NotEvaluable:
            return None

    def _check_start(self, u: np.ndarray) -> None:
        try:
            wrong = disagreement(self.functions, u, self.p0)
        except NotEvaluable as error:
            wrong = f"{error}, at the start"
        if wrong is not None:
            raise ValueError(wrong)
        self._check_symmetries()

    def _check_symmetries(self) -> None:
        """Raise ValueError if the equations do not have a given symmetry; checked once for each choice of parameters."""
        values = self.values
        key = (values.varying, *sorted(item for item in values.values.items() if item[0] != values.varying))
        if not self.generators or key in self.symmetric_for:
            return
        for symmetry in self.generators:
            refuse_asymmetry(
                self.functions, self.in_own_pieces(), symmetry, self.u0[: self.node], self.mixed_rows
            )
        self.symmetric_for.add(key)

    def in_own_pieces(self) -> Callable[[np.ndarray, float], np.ndarray]:
        """Return the function (u, p) -> F that takes the signs of the switches from u."""
        if not self.pieces.count:
            return self.functions.value
        pieces = self.pieces.repeated(1, 1)
        functions = self.functions_in(pieces)

        def value(u: np.ndarray, p: float) -> np.ndarray:
            pieces.choose(u, p)
            return functions.value(u, p)

        return value

    def _check_rows(self, u: np.ndarray) -> None:
        with np.errstate(all="ignore"):
            wrong = empty_row(self.functions, u, self.p0)
        if wrong is not None:
            raise ValueError(wrong)

    def _structure_at(self, u: np.ndarray) -> str:
        try:
            return self.functions.find_structure(u, self.given.get("preconditioner") is not None)
        except NotEvaluable as error:
            raise ValueError(str(error)) from error
