"""The equations of the built-in machines' cycles: data for the compiled kernels, or for their reference in plain Python and numpy.

The empty word has linear equations of its own (`orbits.flows.native.rest_equations`).
"""

from __future__ import annotations

from functools import cache, cached_property, lru_cache
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from contvines.core.table import TableKernels, native_table
from orbits.arguments import Workspace, cycle_data, jacobian, workspace
from orbits.flows.equations import PLAIN, Approach, Equations
from orbits.machines.base import Model
from orbits.machines.native_stepper import number
from orbits.words import Word
from orbits.words.alphabet import LEFT

if TYPE_CHECKING:
    from orbits.flows.native.reference_kernels import ReferenceKernels

_shared = lru_cache(maxsize=64)(workspace)


class NativeKernels(TableKernels):
    """Kernels for the cycles of one model in the native core; the reference uses the same data and arrays (`orbits.arguments`)."""

    natural = True
    matrix = staticmethod(jacobian)


@cache
def _assembled(name: str, machine: int | None) -> NativeKernels | ReferenceKernels:
    if machine is not None:
        return NativeKernels(native_table("core_machine_table", machine))
    from orbits.flows.native.reference_kernels import ReferenceKernels
    from orbits.machines.reference.machine import reference

    return ReferenceKernels(reference(name))


def assemble(model: Model) -> NativeKernels | ReferenceKernels:
    """Return the kernels for `model`, made once per process."""
    return _assembled(model.name, number(model.name))


class NativeEquations(Equations[Model]):
    """Closed chains of elementary maps, against one parameter.

    A motion without impacts can be shifted along the cavity: unless it is symmetric, its mean position is pinned.
    """

    def __init__(
        self,
        model: Model,
        word: Word,
        periods: int,
        parameter: str,
        params: np.ndarray,
        symmetric: bool = False,
        units: tuple[float, float] | None = None,
    ) -> None:
        super().__init__(model, word, periods, parameter, params, symmetric, len(word))
        frame = _frame(_Itself(model), parameter, self.params.tobytes(), units)
        self.path, self.units = frame.path.copy(), frame.units
        pinned = 0 if not word.impact_free else (2 if symmetric else 1)
        self.movable = pinned == 2  # a symmetric motion without impacts
        self.n_multipliers = model.node - 1 if pinned else model.node
        if self.units != PLAIN:  # phases have no unit, then B or w, v and v'
            length, rate = self.units
            self.unit[:, 1] = np.where(word.codes < 2, length * rate, length)
            self.unit[:, 2::2], self.unit[:, 3::2] = length, length * rate
        self.data = cycle_data(
            word.codes[: self.length],
            word.mode_codes[: self.length],
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
        """The kernels of the model."""
        return assemble(self.model)

    def workspace(self) -> Workspace:
        """Return new arrays for the kernels."""
        return workspace(self.length, self.model.node, self.params.size)

    @cached_property
    def scratch(self) -> Workspace:
        """Workspace for single calls, shared by all cycles of one length; its contents do not last."""
        return _shared(self.length, self.model.node, self.params.size)

    def approach(self, u: np.ndarray, p: float, place: int, near: float) -> Approach:
        """Return the speed of the impact at a place and its derivatives; `near` is the step of the difference quotient by the parameter."""
        n, unit = self.model.node, self.unit[place]
        node, own = (
            u[place * n : (place + 1) * n] * unit,
            float(unit[1]),
        )  # the second entry of an impact's node is a speed
        sign = 1.0 if self.word.letter(place).contact == LEFT else -1.0
        cavity, slopes = self.model.cavity_speed(node, self.values(p))
        nearby, _ = self.model.cavity_speed(node, self.values(p + near))
        cavity, nearby = cavity / own, nearby / own
        by_node, push = -sign * slopes * unit / own, np.zeros(n)
        by_node[1] += sign
        push[1] = sign
        return Approach(
            sign * (float(u[place * n + 1]) - cavity), by_node, -sign * (nearby - cavity) / near, push
        )

    def through_flights(self, u: np.ndarray, p: float) -> tuple[np.ndarray, np.ndarray]:
        """Return the derivatives of each flight's equations by the node before it and by the node after it, the mirror included in the last."""
        row = np.empty(2 * self.n_multipliers + self.n_margins)
        self.kernels.examine(self.data, u, p, self.scratch, row)
        A, D = self.scratch.A, self.scratch.D.copy()
        D[-1, :, 1:] *= self.twist
        return A, D


class _Frame(NamedTuple):
    """Data shared by the equations of all words: parameters and how they depend on the varying one, in given and in dimensionless units."""

    path: np.ndarray
    units: tuple[float, float]
    own: np.ndarray
    own_path: np.ndarray
    active: int
    amounts: np.ndarray
    law: np.ndarray


class _Itself:
    """Hashable wrapper that compares machines by identity: equal numbers may be given in different quantities."""

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
    numbers, own_path = params, path
    if units != PLAIN:
        factors = model.factors(units)
        numbers, own_path = params / factors, np.array([path[0] / factors, path[1]])
        law = law.copy() if len(law) else np.vstack([np.ones(params.size), np.eye(params.size)])
        law[0] /= factors
    amounts = np.array(model.amounts(params), dtype=float)
    return _Frame(path, units, numbers, own_path, model.place_of(parameter), amounts, law)
