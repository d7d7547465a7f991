"""The equations of the cycles with one word, as far as all flows share them, and Newton's method for them."""

from __future__ import annotations

from abc import ABC, abstractmethod
from functools import cached_property
from typing import TYPE_CHECKING, Any, Generic, NamedTuple, Protocol, TypeVar

import numpy as np

from contvines.core.table import KernelFunctions
from orbits.flows.trajectory import TWO_PI
from orbits.machines.parameters import along
from orbits.settings import SOLVING

if TYPE_CHECKING:
    from collections.abc import Callable

    from orbits.machines.varying import Varying
    from orbits.words import Word

ModelOf = TypeVar("ModelOf", bound="Varying")

PLAIN = (1.0, 1.0)
"""Units of length and rate of unknowns in the machine's own units."""


class Approach(NamedTuple):
    """Speed with which an impact leaves its wall, in units of the unknowns, and its derivatives.

    Attributes
    ----------
    speed : float
    slopes : ndarray, shape (n,)
        Derivatives by the entries of the node.
    by_parameter : float
        Derivative by the parameter.
    push : ndarray, shape (n,)
        Direction in which a node is moved to change the speed.
    """

    speed: float
    slopes: np.ndarray
    by_parameter: float
    push: np.ndarray


class CycleKernels(KernelFunctions, Protocol):
    """The kernels of a continuation, and two more: Newton's method, and the examination of one solution (see `orbits.flows.plain_kernels`)."""

    @property
    def newton(self) -> Callable[..., tuple[float, int, float]]: ...
    @property
    def examine(self) -> Callable[..., float]: ...


class Equations(ABC, Generic[ModelOf]):
    """The equations of the cycles with one word, against one parameter. A symmetric cycle is solved on half its word and closed by the mirror.

    Parameters
    ----------
    model : Model or Machine
    word : Word
        Of the whole cycle.
    periods : int
        Forcing periods of the whole cycle; 1 for a self-excited machine, whose period is unknown.
    parameter : str
        Name of the varying parameter.
    params : float array (P,)
        Parameter vector; its value of `parameter` is only a starting value.
    symmetric : bool
    whole : int
        Nodes of the whole cycle.

    Attributes
    ----------
    length, dimension, n_multipliers, n_margins : int
        Numbers of unknown nodes (half the word's for a symmetric cycle), unknowns, multipliers and margins.
    twist, shift : float
        Closure: the first node returns with its phase plus `shift` and its other entries times `twist`.
    movable : bool
        Whether solutions could be shifted as a whole if the mirror did not fix them.
    period_shift : float array (N,) or None
        Change of the unknowns when the forcing advances by one period; None without forcing.
    path : float array (2, P)
        How the parameter vector depends on the parameter (`orbits.machines.parameters`).
    units : (float, float)
        Units of length and rate of the unknowns; `unit` is the unit of each entry of the nodes, shape (L, n).
    data
        First argument of the kernels.

    Raises
    ------
    ValueError
        If the parameter is unknown, or `symmetric` is set without a symmetry.
    """

    n_multipliers: int
    movable: bool
    period_shift: np.ndarray | None
    path: np.ndarray
    data: Any
    units: tuple[float, float] = PLAIN

    def __init__(
        self,
        model: ModelOf,
        word: Word,
        periods: int,
        parameter: str,
        params: np.ndarray,
        symmetric: bool,
        whole: int,
    ) -> None:
        params = np.array(params, dtype=float)
        if symmetric and not model.has_mirror(params, parameter):
            raise ValueError(
                f"the machine {model.name!r} has no mirror image along {parameter}, so no symmetric orbits"
            )
        if symmetric and not (word.mirror_symmetric_halves and (periods % 2 == 1 or not model.forced)):
            raise ValueError(f"word {word.text!r} with periods = {periods} has no symmetric orbits")
        self.model, self.word, self.periods = model, word, int(periods)
        self.parameter, self.params = parameter, params
        self.symmetric, self.forced = bool(symmetric), model.forced
        node = len(model.node_names)
        self.length = whole // 2 if symmetric else whole
        self.dimension = self.length * node
        self.twist = -1.0 if symmetric else 1.0
        self.shift = (0.5 if symmetric else 1.0) * TWO_PI * self.periods if self.forced else 0.0
        self.n_margins = len(word.alphabet.columns) * self.length
        self.unit = np.ones((whole, node))
        self.period_shift = np.zeros(self.dimension) if self.forced else None
        if self.period_shift is not None:
            self.period_shift[::node] = TWO_PI

    @property
    @abstractmethod
    def kernels(self) -> CycleKernels:
        """The kernels: linearise, bordered, inspect, newton, examine."""

    @abstractmethod
    def workspace(self) -> Any:
        """Return new arrays for the kernels."""

    @cached_property
    def scratch(self) -> Any:
        """Shared workspace for single calls; its contents do not last."""
        return self.workspace()

    def values(self, p: float | np.ndarray) -> np.ndarray:
        """Return the parameter vector at parameter value `p`, shape (P,); (m, P) for an array of values."""
        return along(self.path, self.params, p)

    def value(self, params: np.ndarray) -> float:
        """Return the value of the varying parameter in a parameter vector."""
        return self.model.amount(self.parameter, params)

    @cached_property
    def began(self) -> float:
        """Value of the varying parameter in `params`."""
        return self.value(self.params)

    def to_multipliers(self, spectrum: np.ndarray) -> np.ndarray:
        """Return the multipliers of the full period from those of the closure map (of half a period: their squares)."""
        spectrum = np.asarray(spectrum, dtype=complex)
        return spectrum**2 if self.twist < 0.0 else spectrum

    def expand(self, u: np.ndarray, p: float | np.ndarray | None = None) -> np.ndarray:
        """Return the nodes of the whole cycle, shape (..., L, n), from the unknowns, shape (..., N).

        The second half of a symmetric cycle is the image of the first about the middle between the walls, at the parameter values `p`, shape
        (...); without them at `params`.
        """
        u = np.asarray(u, dtype=float)
        nodes = u.reshape(*u.shape[:-1], self.length, self.unit.shape[1])
        if self.units != PLAIN:
            nodes = nodes * self.unit[: self.length]
        if self.twist > 0.0:
            return nodes
        image = self.model.image(self.word, nodes, self.params if p is None else self.values(p))
        image[..., 0] += self.shift
        return np.concatenate([nodes, image], axis=-2)

    def reduce(self, nodes: np.ndarray) -> np.ndarray:
        """Return the unknowns, shape (N,), from the nodes of the whole cycle."""
        reduced = np.array(nodes[: self.length], dtype=float, order="C")
        if self.units != PLAIN:
            reduced /= self.unit[: self.length]
        return reduced.ravel()

    def approach(self, u: np.ndarray, p: float, place: int, near: float) -> Approach:
        """Return the speed of the impact at a place and its derivatives; `near` is the step of a difference quotient by the parameter.

        Raises
        ------
        ValueError
            If the word has no impacts.
        """
        raise ValueError(f"the word {self.word.text!r} has no impact at place {place}")

    @abstractmethod
    def through_flights(self, u: np.ndarray, p: float) -> tuple[np.ndarray, np.ndarray | None] | None:
        """Return the derivatives of each flight's equations by the node before it and by the node after it.

        The mirror is included in the last flight. With None in place of the second, the first are derivatives of each node by the one before.
        None if the equations cannot be evaluated or there are no flights.
        """


def newton(
    system: Equations,
    guess: np.ndarray,
    p: float,
    border: np.ndarray | None = None,
    limit: int = 40,
) -> tuple[np.ndarray, float, float, np.ndarray]:
    """Solve F(u, p) = 0 at fixed p, or in the hyperplane through the guess with normal vector `border`.

    Returns
    -------
    u : float array (N,)
    p : float
    residual : float
        Largest residual; infinity if the method does not converge.
    tangent : float array (N + 1,)
        Direction of the branch, not normalised.
    """
    row = np.zeros(system.dimension + 1)
    row[-1] = 1.0
    if border is not None:
        row[:] = border
    step, tangent = np.empty_like(row), np.empty_like(row)
    u = np.array(guess, dtype=float)
    residual, _, p = system.kernels.newton(
        system.data, u, p, system.scratch, row, step, tangent, SOLVING.last_step, limit
    )
    return u, float(p), float(residual), tangent


def solved_nodes(
    system: Equations, nodes: np.ndarray, params: np.ndarray, limit: int = 40
) -> np.ndarray | None:
    """Return the nodes of the solution near these nodes, at these parameters; None if Newton's method does not converge."""
    value = system.value(params)
    u, residual = solved_at(system, system.reduce(nodes), value, limit)
    if not residual < SOLVING.scaled * max(1.0, float(np.abs(u).max(initial=0.0))):
        return None
    return system.expand(u, value)[: len(nodes)]


def solved_at(system: Equations, guess: np.ndarray, p: float, limit: int = 40) -> tuple[np.ndarray, float]:
    """Return the solution at a parameter value, and its residual (infinite if there is none)."""
    u, _, residual, _ = newton(system, guess, p, limit=limit)
    return u, residual
