"""What problems made of Python callables have in common: parameters, scales, checks, and what they say when they fail."""

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

TERMS = 62  # roundings of more unknowns than this cancel


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
        A matrix relative to which eigenvalues are watched for branch points where there is no spectrum.
    many : bool
        Whether they are watched only where a cheaper number asks for it; see :mod:`.spectra`.
    close : bool
        Whether they are watched here; see `closer`.
    signed : bool
        Whether the sign of the determinant is known: not of a Jacobian without a matrix.
    trouble : str
        Why the equations could not be evaluated the last time that happened.
    unsolved : bool
        Whether the last linear system, of a Jacobian without a matrix, was not solved.
    generators, symmetric_for, mixed_rows
        Symmetries by name, and for which parameters they are known to be some; see :mod:`.symmetries`.
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
        """The equations and their given derivatives in a piece.

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
        """The equations with their derivatives in other pieces."""
        return self.functions.of(*self._wrapped(pieces))

    def closer(self) -> Self:
        """The same problem, watched by its eigenvalues."""
        problem = copy(self)
        problem.data, problem.close = problem, True
        return problem

    # ------------------------------------------------------------------ parameters
    def against(self, parameter: str, values: Mapping[str, float] | None = None) -> Self:
        """The same problem with another parameter varying, and with other values of some parameters.

        Cheap: nothing is evaluated. Scales are learned again where another parameter varies.

        Parameters
        ----------
        parameter : str
            The one that varies from now on.
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
        return other._own()

    def _own(self) -> Self:
        """To be called on a copy: what refers to the problem refers to the copy."""
        self.data = self
        return self

    # ------------------------------------------------------------------ the equations
    @abstractmethod
    def residuals(self, u: np.ndarray, p: float) -> np.ndarray:
        """F alone."""

    def margins(self, u: np.ndarray, p: float) -> np.ndarray:
        """Switches with the signs of the pieces: positive inside."""
        nodes = np.asarray(u)[: self.node * len(self.pieces.signs)].reshape(-1, self.node)
        return self.pieces.margins(nodes, p)

    def margin_kind(self, j: int) -> str:
        """Every border of a piece is a switch."""
        return "switch"

    def beyond(self, point: BorderPoint) -> list[Seed]:
        """The solutions on the other side of a switch."""
        return self.pieces.beyond(self, point)

    @abstractmethod
    def with_pieces(self, pieces: Pieces) -> Pieced:
        """The same problem in other pieces."""

    # ------------------------------------------------------------------ scales
    node: int

    def amplitude(self, direction: np.ndarray) -> float:
        """Length of a direction as normal forms measure it: Euclidean, over the unknowns (over the first point of a cycle)."""
        return float(np.linalg.norm(direction[: self.node]))

    def of_unknowns(self, each: np.ndarray) -> np.ndarray:
        """What `functions` know of each of their arguments, of each unknown."""
        return each

    @property
    def lengths(self) -> np.ndarray:
        """Length over which the equations bend in each unknown."""
        return self.of_unknowns(self.functions.lengths)

    @property
    def noise(self) -> float:
        """Accuracy to which unknowns can be obtained, relative to their scale; 0: to roundoff."""
        return 0.0 if self.scales is None else self.scales.noise

    @property
    def scales_learned(self) -> bool:
        """Whether sizes of the unknowns come from a look round the start, not from the user."""
        return self.scales is not None and self.given_scale is None

    def scale_within(self, within: tuple[float, float]) -> np.ndarray:
        """Typical sizes of unknowns and parameter, shape (N + 1,); learned when they are asked for the first time."""
        scales = self.scales
        self._check_symmetries()
        if scales is None:
            from .scouting import learn

            scales = self.scales = learn(self, within, self.given_scale)
        return scales.vector

    def sizes(self) -> tuple[np.ndarray, np.ndarray]:
        """Typical sizes of equations and unknowns, 1 as long as they are not known."""
        scales = self.scales
        if scales is None:
            return np.ones(self.dimension), np.ones(self.dimension)
        return scales.rows, scales.unknowns

    @property
    def side(self) -> np.ndarray:
        """The right-hand side that is watched, shape (N + 1,)."""
        if self._side is None or self._side[0] is not self.scales:
            self._side = self.scales, side(self.sizes()[0])
        return self._side[1]

    def rates(self, work: DenseWork | SparseWork) -> list[float]:
        """Sizes of the eigenvalues of dF/du, where they are wanted and can be obtained cheaply."""
        return []

    # ------------------------------------------------------------------ algebra
    @property
    def algebra(self) -> ModuleType:
        """The module with the kernels that fit the Jacobian."""
        if self.functions.structure == "dense":
            return dense
        from .large import sparse

        return sparse

    @property
    def kernels(self) -> Kernels:
        """The kernels that fit the Jacobian: dense, sparse, or matrix-free."""
        return self.algebra.KERNELS

    def workspace(self) -> DenseWork | SparseWork:
        """Arrays for the kernels."""
        return self.algebra.workspace(self)

    # ------------------------------------------------------------------ what is wrong
    @property
    def stuck(self) -> str:
        """A sentence on linear systems that are not solved; empty where they are."""
        if not self.unsolved:
            return ""
        better = "a preconditioner=" if self.given["preconditioner"] is None else "a better preconditioner="
        return f"GMRES does not solve the linear systems of the matrix-free Jacobian; {better} would help"

    @property
    def signed(self) -> bool:
        """Whether the sign of the determinant is known."""
        return self.functions.structure != "operator"

    def uncertainty(self) -> float:
        """Relative accuracy of what was evaluated last: of derivatives by differences, of noisy equations, and of rounding."""
        errors, least = (
            self.functions.errors,
            max(self.noise, 0.5 * ROUNDED * (2 + min(self.dimension, TERMS))),
        )
        if self.scales is None or not errors.any():
            return least
        scale = self.scales.unknowns[: len(errors)]
        return max(float((errors * scale).max() / self.scales.rows.max()), least)

    def doubts(self, work: DenseWork | SparseWork, rounding: float) -> np.ndarray | csc_array | None:
        """Bounds of the errors of the entries of (F_u, F_p), shape (N, N + 1): rounding, and what differences are known to.

        A sparse matrix of a sparse problem, None of one without a matrix.
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
        """Why a branch ends where Newton's method fails, as far as that can be determined; else an empty string.

        Parameters
        ----------
        u, p, tangent
            The last point, and the unit tangent in which the branch was followed.
        evaluable : bool
            False: the equations could not be evaluated further on.
        """
        if not evaluable:
            return self.trouble
        for beyond in (0.0, DERIVATIVES.aside):
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
                where = f"near {self.parameter} = {value:.6g} (row {found.row})"
                if found.kind == "jump":
                    return f"the equations jump {where}"
                return f"the equations have a kink {where}; switches= would select their pieces"
        if self.noise > DERIVATIVES.felt:
            j = int(np.argmax(self.functions.noise))
            return (
                f"{self.functions.name} has noise of {self.functions.noise[j]:.1g} in row {j}, which moves the solution by "
                f"{self.noise:.1g} of its size{' or more' if self.noise >= DERIVATIVES.believed else ''}: it may be too much for a branch to be followed"
            )
        return ""

    def check(self, u: np.ndarray, p: float) -> str | None:
        """A sentence on given derivatives that disagree with the equations at a solution; None if they agree."""
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
        """Refuse a symmetry of which the equations know nothing, once for each choice of parameters."""
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
        """The equations, each state in the piece in which it lies."""
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
