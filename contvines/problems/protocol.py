"""What contvines must be told about a problem: the protocol, and nothing else.

The contract, in words:

1. A problem is F(u, p) = 0 with N unknowns u (a flat float64 array) and as many equations, and one parameter p.
2. ``kernels`` holds three functions, compiled by numba or plain Python, with the same signatures:

   ``linearise(data, u, p, work) -> float``
       evaluates F, dF/du and dF/dp into ``work`` and returns the largest absolute residual (inf: not evaluable).
       ``work[0]`` is F itself (any C-contiguous shape with N entries); it may be overwritten between the calls.
   ``bordered(data, work, border, n, step, tangent) -> float``
       solves ``[[F_u, F_p], [border]] x = rhs`` with one elimination for ``rhs = (-F, n)`` (into step) and
       ``rhs = (0, 1)`` (into tangent); F is taken from ``work[0]``. Returns the sign of the determinant; 0 means
       singular, and the solution is then that of a matrix with a tiny pivot.
   ``inspect(data, u, p, work, row) -> None``
       from the linearisation in ``work``: ``row[:2 m]`` are the m multipliers (or eigenvalues) as re, im pairs,
       ``row[2 m:]`` are the margins. A margin is positive on a real solution, +inf where it does not apply.
   Loci against a second parameter need five more, optional, entries:

   ``assign(data, other, value) -> None``
       gives the parameter that varies in the problem of ``other`` (from ``against``) a value in ``data``, in place.
   ``column``
       place of F_p in ``work`` (as work[0] that of F; any C-contiguous shape with N entries); it may be overwritten
       between the calls, and ``bordered`` then takes that column.
   ``flip(data, work, sign) -> None``
       maps only: turns F_u in ``work`` into what acts on perturbations that change sign over the period (sign = -1), and
       back (sign = 1).
   ``transpose(data, work, column, other) -> None``
       writes the transposed F_u, with ``column`` in the place of F_p, into another workspace.
   ``matrix(data, work) -> ndarray``
       F_u as it stands in ``work``, shape (N, N); always plain Python, for normal forms at single points.
3. ``data`` and ``workspace()`` are the opaque first and last arguments of the kernels.
4. ``spectrum`` says how the raw spectrum is read: "map" (unit circle), "flow" (imaginary axis), "none". A problem without one
   may still have real eigenvalues watched for branch points: ``detection`` is then "real".
   ``flip_kind`` says what a raw multiplier -1 means: "period-doubling" or "symmetry-breaking".
5. Solutions may be equal up to ``period_shift`` and ``symmetries``; ``canonical(u, p)`` returns a hashable key and a
   vector which are the same for solutions that are one and the same thing. ``root(u, p)`` returns the smaller problem
   and its unknowns for a solution that only repeats a shorter one (a cycle run through twice), else None.
6. ``offspring`` hands out the larger problem in which a special point is a branch point, ``beyond`` the solutions
   on the other side of a border.

Satisfied by structure: nothing has to be imported or inherited. :class:`ProblemDefaults` is a convenience.
"""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Hashable, Sequence
from dataclasses import dataclass, field
from typing import Any, NamedTuple, Protocol

import numpy as np


@dataclass(frozen=True)
class Kernels:
    """The functions of a problem (see the contract above).

    Parameters
    ----------
    linearise, bordered, inspect : callable
        All three compiled by numba in nopython mode, or all three plain Python.
    compiled : bool
        Whether they are compiled.
    digest : str
        Identifies their sources, the files they call included; part of the name under which the compiled
        continuation loop is cached on disk. Empty: taken from the files that define the three functions.
    assign, flip, transpose, matrix : callable, optional
    column : int
        For loci against a second parameter; see the contract.
    """

    linearise: Callable[..., float]
    bordered: Callable[..., float]
    inspect: Callable[..., None]
    compiled: bool = False
    digest: str = ""
    assign: Callable[..., None] | None = None
    flip: Callable[..., None] | None = None
    transpose: Callable[..., None] | None = None
    column: int = -1
    matrix: Callable[..., np.ndarray] | None = None


def kernels_digest(kernels: Any) -> str:
    """A short digest of the sources of some kernels: their own ``digest``, else of the files that define them."""
    if getattr(kernels, "digest", ""):
        return str(kernels.digest)
    digest = hashlib.blake2b(digest_size=8)
    for kernel in (kernels.linearise, kernels.bordered, kernels.inspect):
        code = getattr(kernel, "py_func", kernel).__code__
        digest.update(f"{code.co_filename}:{code.co_name}".encode())
        try:
            with open(code.co_filename, "rb") as source:
                digest.update(source.read())
        except OSError:
            digest.update(code.co_code)
    return digest.hexdigest()


@dataclass(frozen=True)
class Symmetry:
    """An image of u that solves the same problem.

    Parameters
    ----------
    kind : str
        The bifurcation at which branches with less symmetry leave the fixed space: "symmetry-breaking" for a mirror,
        "period-doubling" for the shift of a doubled cycle by its half.
    apply : callable
        u -> the image of u, both of shape (N,).
    root : callable, optional
        u -> (problem, u) of the smaller problem for a solution that lies in the fixed space.
    """

    kind: str
    apply: Callable[[np.ndarray], np.ndarray]
    root: Callable[[np.ndarray], tuple[Any, np.ndarray]] | None = None


class Embedding(NamedTuple):
    """A solution seen in a larger problem, in which it is a branch point."""

    problem: Any
    u: np.ndarray
    tangent: np.ndarray
    kind: str


@dataclass(frozen=True)
class Seed:
    """A solution from which a branch can be traced.

    Parameters
    ----------
    problem : Problem
    u : ndarray, shape (N,)
    p : float
    tangent : ndarray, shape (N + 1,), optional
        Direction in which the branch leaves; None: both ways.
    kind : str
        "start", "border", "root", or the kind of the special point.
    note : str
        A sentence for the graph.
    persistence : bool
        At a border: the branch simply goes on with another word (else: a nonsmooth fold).
    """

    problem: Any
    u: np.ndarray
    p: float
    tangent: np.ndarray | None = None
    kind: str = "start"
    note: str = ""
    persistence: bool = True


class Problem(Protocol):
    """The protocol; see the contract at the top of this module."""

    dimension: int
    parameter: str
    spectrum: str
    flip_kind: str
    n_multipliers: int
    n_margins: int
    kernels: Any
    data: Any
    period_shift: np.ndarray | None
    symmetries: Sequence[Any]
    measure_names: Sequence[str]

    def workspace(self) -> Any: ...

    def margin_kind(self, j: int) -> str: ...

    def to_multipliers(self, spectrum: np.ndarray) -> np.ndarray: ...

    def offspring(
        self, kind: str, u: np.ndarray, p: float, tangent: np.ndarray, multiplier: complex
    ) -> Sequence[Any]: ...

    def beyond(self, point: Any) -> Sequence[Any]: ...

    def canonical(self, u: np.ndarray, p: float) -> tuple[Hashable, np.ndarray]: ...

    def measures(self, names: Sequence[str], u: np.ndarray, p: np.ndarray) -> dict[str, np.ndarray]: ...

    def describe(self) -> dict[str, Any]: ...

    def orbit(self, u: np.ndarray, p: float) -> Any: ...

    def replay(self, u: np.ndarray, p: float) -> float | None: ...

    def root(self, u: np.ndarray, p: float) -> tuple[Any, np.ndarray] | None: ...


@dataclass(frozen=True)
class Solution:
    """What ``orbit`` returns for problems that have nothing better: the bare numbers."""

    parameter: str
    value: float
    u: np.ndarray = field(repr=False)


class ProblemDefaults:
    """Answers of a problem without symmetries, margins and larger problems."""

    parameter = "p"
    spectrum = "none"
    detection = ""
    flip_kind = "period-doubling"
    n_multipliers = 0
    n_margins = 0
    dimension = 0
    period_shift: np.ndarray | None = None
    symmetries: tuple[Symmetry, ...] = ()

    def margin_kind(self, j: int) -> str:
        raise IndexError(f"this problem has no margins, so there is no margin {j}")

    def to_multipliers(self, spectrum: np.ndarray) -> np.ndarray:
        return np.asarray(spectrum, dtype=complex)

    def offspring(
        self, kind: str, u: np.ndarray, p: float, tangent: np.ndarray, multiplier: complex
    ) -> list[Embedding]:
        return []

    def beyond(self, point: Any) -> list[Seed]:
        return []

    def canonical(self, u: np.ndarray, p: float) -> tuple[Hashable, np.ndarray]:
        return (type(self).__name__, self.dimension), np.asarray(u, dtype=float)

    @property
    def measure_names(self) -> tuple[str, ...]:
        return ("norm", *(f"u{i}" for i in range(self.dimension)))

    def measures(self, names: Sequence[str], u: np.ndarray, p: np.ndarray) -> dict[str, np.ndarray]:
        u = np.atleast_2d(u)
        result = {}
        for name in names:
            if name == "norm":
                result[name] = np.linalg.norm(u, axis=1)
            elif name in self.measure_names:
                result[name] = u[:, int(name[1:])].copy()
            else:
                raise KeyError(f"there is no measure {name!r}; choose from {', '.join(self.measure_names)}")
        return result

    def describe(self) -> dict[str, Any]:
        return {"name": type(self).__name__, "factory": None}

    def orbit(self, u: np.ndarray, p: float) -> Any:
        return Solution(self.parameter, float(p), np.array(u))

    def replay(self, u: np.ndarray, p: float) -> float | None:
        return None

    def root(self, u: np.ndarray, p: float) -> tuple[Any, np.ndarray] | None:
        return None
