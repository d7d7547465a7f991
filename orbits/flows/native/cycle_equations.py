"""The equations of the cycles with one word: what the compiled kernels need, and how unknowns and nodes go together.

A symmetric cycle is solved for on half its word, closed by the mirror. The empty word has linear equations of its own
(`orbits.flows.native.rest_equations`), with the same members.
"""

from __future__ import annotations

from functools import lru_cache
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from orbits.arguments import Workspace, cycle_data, workspace
from orbits.flows.against import Against
from orbits.flows.native.kernels import assemble
from orbits.flows.protocol import PLAIN, Approach
from orbits.machines.base import Model
from orbits.words import Word
from orbits.words.alphabet import LEFT

if TYPE_CHECKING:
    from orbits.flows.native.kernels import NativeKernels
    from orbits.flows.native.reference_kernels import ReferenceKernels
    from orbits.flows.native.rest_equations import RestEquations

_shared = lru_cache(maxsize=64)(workspace)


class Equations(Against[Model]):
    """Closed chains of elementary maps, against one parameter.

    Attributes
    ----------
    length : int
        Number of nodes that are unknown; half the word's if `symmetric`.
    dimension, n_multipliers, n_margins : int
    twist, shift : float
        Closure: the first node returns with its phase plus `shift` and all else times `twist`.
    movable : bool
        Whether solutions may be shifted as a whole; of those that are not symmetric the mean position is pinned.
    units : (float, float)
        Length and rate in which the unknowns are counted; see `Model.natural_units`.
    data : CycleData
        First argument of the kernels.

    Raises
    ------
    ValueError
        If the parameter is unknown, or `symmetric` is asked where there is no symmetry.
    """

    def __init__(
        self,
        model: Model,
        word: Word,
        periods: int,
        parameter: str,
        params: np.ndarray,
        symmetric: bool,
        units: tuple[float, float] | None = None,
    ) -> None:
        if symmetric and not model.has_mirror(params, parameter):
            raise ValueError(
                f"the model {model.name!r} has no mirror image along {parameter}, so no symmetric orbits"
            )
        if symmetric and not (word.mirror_symmetric_halves and periods % 2 == 1):
            raise ValueError(f"word {word.text!r} with periods = {periods} has no symmetric orbits")
        self.model, self.params, self.parameter = model, params, parameter
        frame = _frame(_Itself(model), parameter, params.tobytes(), units)
        self.path, self.units = frame.path.copy(), frame.units
        length = len(word) // 2 if symmetric else len(word)
        n = model.node
        self.length, self.dimension = length, length * n
        self.twist = -1.0 if symmetric else 1.0
        self.shift = np.pi * periods * (1 if symmetric else 2)
        self.word = word
        pinned = 0 if not word.impact_free else (2 if symmetric else 1)
        self.movable = pinned == 2  # a symmetric motion without impacts
        self.n_multipliers = n - 1 if pinned else n
        self.n_margins = len(word.alphabet.columns) * length
        self.period_shift = np.zeros(self.dimension)
        self.period_shift[::n] = 2.0 * np.pi
        self.codes = word.codes[:length]
        self.unit = unit_nodes(word, n, self.units)
        self.data = cycle_data(
            self.codes,
            word.mode_codes[:length],
            frame.own,
            frame.path if self.units == PLAIN else frame.own_path,
            self.twist,
            self.shift,
            pinned,
            frame.active,
            frame.amounts,
            frame.law,
        )
        if self.units == PLAIN:
            self.path = self.data.path

    @property
    def kernels(self) -> NativeKernels | ReferenceKernels:
        """linearise, bordered, inspect, newton, examine of the model."""
        return assemble(self.model)

    def workspace(self) -> Workspace:
        """Arrays for the kernels."""
        return workspace(self.length, self.model.node, self.params.size)

    @property
    def scratch(self) -> Workspace:
        """A workspace for single calls, whose contents nobody relies on; cycles of one length share it."""
        return _shared(self.length, self.model.node, self.params.size)

    def expand(self, u: np.ndarray, p: float | np.ndarray | None = None) -> np.ndarray:
        """Nodes of the whole cycle, shape (..., L, n), from the unknowns, shape (..., N).

        The image of half a cycle is taken about the middle between the walls at the parameter values `p`, shape (...); without
        them at the one in the parameter vector.
        """
        u = np.asarray(u, dtype=float)
        nodes = u.reshape(*u.shape[:-1], self.length, self.model.node)
        if self.units != PLAIN:
            nodes = nodes * self.unit[: self.length]
        if self.twist > 0.0:
            return nodes
        params = self.params if p is None else self.values(p)
        image = self.model.image(self.codes, nodes, params)
        image[..., 0] += self.shift
        return np.concatenate([nodes, image], axis=-2)

    def reduce(self, nodes: np.ndarray) -> np.ndarray:
        """Unknowns, shape (N,), from the nodes of the whole cycle."""
        own = np.array(nodes[: self.length], dtype=float, order="C")
        if self.units != PLAIN:
            own /= self.unit[: self.length]
        return own.ravel()

    def approach(self, u: np.ndarray, p: float, place: int, near: float) -> Approach:
        """Of the impact at a place; the dependence on the parameter from a difference of size `near`."""
        n, unit = self.model.node, self.unit[place]
        node, own = (
            u[place * n : (place + 1) * n] * unit,
            float(unit[1]),
        )  # the second entry of an impact's node is a speed
        sign = 1.0 if self.word.letter(place).contact == LEFT else -1.0
        cavity, slopes = self.model.cavity_speed(node, self.values(p))
        beside, _ = self.model.cavity_speed(node, self.values(p + near))
        cavity, beside = cavity / own, beside / own
        by_node, push = -sign * slopes * unit / own, np.zeros(n)
        by_node[1] += sign
        push[1] = sign
        return Approach(
            sign * (float(u[place * n + 1]) - cavity), by_node, -sign * (beside - cavity) / near, push
        )

    def through_flights(self, u: np.ndarray, p: float) -> tuple[np.ndarray, np.ndarray] | None:
        """Derivatives of each flight's equations by the node before it and after it, the mirror in the last."""
        row = np.empty(2 * self.n_multipliers + self.n_margins)
        self.kernels.examine(self.data, u, p, self.scratch, row)
        A, D = self.scratch.A, self.scratch.D.copy()
        D[-1, :, 1:] *= self.twist
        return A, D


class _Frame(NamedTuple):
    """What the equations of all words have in common: numbers and how they follow the parameter, in the machine's units and in its own."""

    path: np.ndarray
    units: tuple[float, float]
    own: np.ndarray
    own_path: np.ndarray
    active: int
    amounts: np.ndarray
    law: np.ndarray


class _Itself:
    """A machine as a key: machines that are equal as numbers may be given in other quantities."""

    __slots__ = ("model",)

    def __init__(self, model: Model) -> None:
        self.model = model

    def __hash__(self) -> int:
        return id(self.model)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, _Itself) and self.model is other.model


@lru_cache(maxsize=64)
def _frame(itself: _Itself, parameter: str, values: bytes, units: tuple[float, float] | None) -> _Frame:
    model, params = itself.model, np.frombuffer(values)
    path, law = model.path(parameter, params), model.law
    units = model.natural_units(params) if units is None else units
    own, own_path = params, path
    if units != PLAIN:
        factors = model.factors(units)
        own, own_path = params / factors, np.array([path[0] / factors, path[1]])
        law = law.copy() if len(law) else np.vstack([np.ones(params.size), np.eye(params.size)])
        law[0] /= factors
    amounts = np.array(model.amounts(params), dtype=float)
    return _Frame(path, units, own, own_path, model.place_of(parameter), amounts, law)


def unit_nodes(word: Word, node: int, units: tuple[float, float]) -> np.ndarray:
    """What one dimensionless node is, shape (L, n): phases have no unit, then B or w, v and v'."""
    length, rate = units
    unit = np.ones((len(word), node))
    if units == PLAIN:
        return unit
    unit[:, 1] = np.where([letter in "LR" for letter in word.events], length * rate, length)
    unit[:, 2::2], unit[:, 3::2] = length, length * rate
    return unit


def equations(
    model: Model,
    word: Word,
    periods: int,
    parameter: str,
    params: np.ndarray,
    symmetric: bool = False,
    units: tuple[float, float] | None = None,
) -> Equations | RestEquations:
    """The equations of the cycles with this word."""
    if not len(word):
        from orbits.flows.native.rest_equations import RestEquations

        return RestEquations(model, parameter, params)
    return Equations(model, word, int(periods), parameter, params, symmetric, units)
