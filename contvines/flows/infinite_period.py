"""Limits of cycles whose period grows without bound: homoclinic orbits, heteroclinic cycles, saddle-nodes, cycles that come to rest.

Let s be the arclength along the branch and T' = dT/ds. The time at which the cycle crosses the plane across its motion at a point x changes
along the branch by

    dt/ds - f . (dx/ds) / (f . f),

with x and t of a node. The time between two planes grows by a share of T'. Near an equilibrium to which the cycle tends, this share is not
small: nearly one for a homoclinic orbit, and for a heteroclinic cycle the shares of all equilibria add up to one. Near an equilibrium that the
limit passes at a distance, the share tends to zero.

If the whole cycle comes to rest, as at the circle of equilibria where a rotating wave reverses its rotation, its largest speed falls as 1 / T;
otherwise the largest speed tends to that of the limit.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum
from typing import TYPE_CHECKING

import numpy as np

from contvines.shared.numbers import TINY

from . import mesh

if TYPE_CHECKING:
    from ..problems.protocol import BorderPoint
    from .cycle_mesh import CycleMesh


FAR = 0.05  # largest distance of an equilibrium from the point of lowest speed, in sizes of the cycle, at which the cycle tends to it
SHARE = 0.01  # smallest share of the growth of the period at an equilibrium that belongs to the limit
# exponent of the period in the largest speed that separates cycles that come to rest (-1) from others (0)
HALF = -0.5


class Limit(StrEnum):
    """Kinds of limits of cycles with growing period."""

    HOMOCLINIC = "homoclinic"
    HETEROCLINIC = "heteroclinic"
    SADDLE_NODE = "saddle-node"
    AT_REST = "at-rest"


@dataclass(frozen=True)
class Saddle:
    """An equilibrium near which the cycle stays longer and longer.

    Attributes
    ----------
    place : ndarray, shape (d,)
    eigenvalues : ndarray of complex, shape (d,)
    share : float
        Part of the growth of the period that is spent near the equilibrium.
    """

    place: np.ndarray
    eigenvalues: np.ndarray
    share: float

    def __str__(self) -> str:
        word = "saddle-focus" if np.iscomplex(self.eigenvalues).any() else "saddle"
        values = ", ".join(_value_text(value) for value in np.sort_complex(self.eigenvalues))
        return f"the {word} at {_place(self.place)} with eigenvalues {values}"


@dataclass(frozen=True)
class InfinitePeriod:
    """The limit of cycles whose period grows without bound.

    Attributes
    ----------
    limit : Limit
    period : float
        Period of the last cycle.
    slowest : ndarray, shape (d,)
        State of the last cycle with the lowest speed.
    saddles : tuple of Saddle
        One for a homoclinic orbit, several in the order of passage for a heteroclinic cycle, else none.
    parameter, value : str, float
        For a cycle that comes to rest: parameter and its value in the limit, by linear extrapolation of 1 / T to zero.
    """

    limit: Limit
    period: float
    slowest: np.ndarray
    saddles: tuple[Saddle, ...]
    parameter: str
    value: float

    def __str__(self) -> str:
        match self.limit:
            case Limit.HOMOCLINIC:
                return f"homoclinic to {self.saddles[0]}; period {self.period:.6g}"
            case Limit.HETEROCLINIC:
                return (
                    f"heteroclinic cycle of {' and '.join(map(str, self.saddles))}; period {self.period:.6g}"
                )
            case Limit.SADDLE_NODE:
                return f"saddle-node on the cycle: the period, {self.period:.6g} here, grows as the cycle becomes slow near {_place(self.slowest)}, where there is no equilibrium yet"
            case Limit.AT_REST:
                return (
                    f"the cycle comes to rest as a whole: its period, {self.period:.6g} here, grows as its speed falls everywhere. The limit is a circle of equilibria at "
                    f"{self.parameter} = {self.value:.6g}, as for a rotating wave whose rotation reverses there; begin beyond it to continue"
                )


def infinite_period(problem: CycleMesh, point: BorderPoint) -> InfinitePeriod:
    """Return the limit of the cycles of a branch whose period grows without bound towards its end `point`."""
    ending, p = Ending(problem, point), float(point.value)
    value = p + ending.period * float(point.tangent[-1]) / ending.growth if ending.growth else p
    value = value if abs(value) > problem.flow.settings.rounded * abs(p) else 0.0
    limit, saddles = Limit.AT_REST, ()
    if not ending.exponent() < HALF:
        saddles = ending.saddles()
        limit = (Limit.SADDLE_NODE, Limit.HOMOCLINIC, Limit.HETEROCLINIC)[min(len(saddles), 2)]
    slowest = ending.x[int(np.argmin(ending.speeds))]
    return InfinitePeriod(limit, ending.period, slowest, saddles, problem.parameter, value)


class Ending:
    """The last cycle of a branch and its change along the branch: states x, rates and derivatives ``moved`` at the nodes, T and T' (``growth``)."""

    def __init__(self, problem: CycleMesh, point: BorderPoint) -> None:
        self.problem, self.tangent, self.p = problem, point.tangent, float(point.value)
        x, self.period, self.widths = problem.parts(point.u, point.value)
        self.x = x.reshape(-1, problem.node)
        self.growth = float(point.tangent[problem.states])
        self.moved = point.tangent[: problem.states].reshape(self.x.shape)
        self.rates, self.sizes = problem.field(self.x, self.p), np.ptp(self.x, axis=0)
        self.units = np.maximum(self.sizes, TINY)
        self.speeds = np.linalg.norm(self.rates / self.units, axis=1)

    def exponent(self) -> float:
        """Return d log(largest speed) / d log(period) along the branch, in the plane across the motion; 0 if the period does not change."""
        if not self.growth:
            return 0.0
        field, k = self.problem.field, int(np.argmax(self.speeds))
        x, rate, moved = self.x[k : k + 1], self.rates[k] / self.units, self.moved[k] / self.units
        across = self.units * (moved - rate * (rate @ moved) / (rate @ rate))
        change = field.jacobian(x, self.p)[0] @ across + field.slope(x, self.p)[0] * self.tangent[-1]
        return float(rate @ (change / self.units) / (rate @ rate) * self.period / self.growth)

    def saddles(self) -> tuple[Saddle, ...]:
        """Return the saddles near which the cycle stays longer and longer, in the order of passage, beginning with the largest share."""
        x, p, sizes, speeds, delays = self.x, self.p, self.sizes, self.speeds, self._delays()
        least = np.flatnonzero((speeds <= np.roll(speeds, 1)) & (speeds < np.roll(speeds, -1)))
        slowest = int(np.argmin(speeds))
        found: list[Saddle] = []
        for k in sorted({*least.tolist(), slowest}):
            place = nearby_equilibrium(self.problem, x[k], p, sizes)
            if place is None:
                continue
            values = np.linalg.eigvals(self.problem.field.jacobian(place[None], p)[0])
            if (values.real < 0.0).all() or (values.real > 0.0).all():
                continue
            first, last = _nodes_around((np.abs(x - place) <= FAR * sizes).all(axis=1), k)
            turns = delays[-1] if last < first else 0.0
            share = float((delays[last] - delays[first] + turns) / delays[-1]) if delays[-1] else np.nan
            same = [i for i, other in enumerate(found) if (np.abs(other.place - place) <= FAR * sizes).all()]
            if same:
                if share > found[same[0]].share:
                    found[same[0]] = Saddle(place, values, share)
            elif share > SHARE or k == slowest:
                found.append(Saddle(place, values, share))
        longest = max(range(len(found)), key=lambda i: found[i].share, default=0)
        return tuple(found[longest:] + found[:longest])

    def _delays(self) -> np.ndarray:
        """Changes along the branch of the times at which the cycle crosses the planes at the nodes; the last entry is T'."""
        problem = self.problem
        f, change = self.rates / problem.node_scale, self.moved / problem.node_scale
        lengths = self.growth * self.widths + self.period * self.tangent[:-1][problem.held]
        delays = mesh.node_places(problem.rule, lengths) - (f * change).sum(axis=1) / np.maximum(
            (f * f).sum(axis=1), TINY
        )
        return np.append(delays, self.growth)


def _nodes_around(near: np.ndarray, k: int) -> tuple[int, int]:
    """The last node before node k and the first one after it, on the closed cycle, that are not near the equilibrium."""
    away = np.flatnonzero(~near)
    if not len(away):
        return 0, len(near) - 1
    ahead = away[np.searchsorted(away, k) % len(away)]
    return int(away[np.searchsorted(away, k) - 1]), int(ahead)


def _place(x: np.ndarray) -> str:
    return f"({', '.join(f'{v:.6g}' for v in x)})"


def _value_text(value: complex) -> str:
    return f"{value.real:.4g}" if value.imag == 0.0 else f"{value:.4g}"


def nearby_equilibrium(
    problem: CycleMesh, start: np.ndarray, p: float, sizes: np.ndarray
) -> np.ndarray | None:
    """Return the equilibrium to which Newton's method converges from a point of a cycle with these sizes; None if it fails or moves far away."""
    least = problem.flow.settings.rounded
    y = problem.field.rest(start, p, sizes, least, FAR)
    return None if y is None else np.where(np.abs(y) > least * sizes, y, 0.0)
