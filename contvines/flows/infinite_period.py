"""What a cycle becomes where its period grows without bound.

Let s be the length along the branch and T' = dT/ds. The time t at which the cycle passes the plane across its motion at a point x changes by

    dt/ds - f . (dx/ds) / (f . f),

x and t being those of a node. Between two planes it grows by a share of T'. Beside an equilibrium to which the cycle tends that share is not small
(of a homoclinic orbit nearly one, of heteroclinic cycles the shares of all equilibria are one together); beside another one that it passes at a
distance the share tends to zero, as the cycle itself tends to a limit there.

Where all of the cycle comes to rest, as on the circle of equilibria at which a rotating wave turns round, its largest speed falls as 1 / T; else it
tends to that of the limit.
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


FAR = 0.05  # sizes of a cycle: an equilibrium nearer than that to a point of least speed is the one at which it stays
SHARE = 0.01  # of the growth of the period: less of it is none
HALF = (
    -0.5
)  # exponent of the period in the largest speed, between -1 of a cycle that comes to rest and 0 of others


class Limit(StrEnum):
    """What a cycle of infinite period is."""

    HOMOCLINIC = "homoclinic"
    HETEROCLINIC = "heteroclinic"
    SADDLE_NODE = "saddle-node"
    AT_REST = "at-rest"


@dataclass(frozen=True)
class Saddle:
    """An equilibrium at which a cycle stays longer and longer.

    Attributes
    ----------
    place : ndarray, shape (d,)
    eigenvalues : ndarray of complex, shape (d,)
    share : float
        Of the growth of the period.
    """

    place: np.ndarray
    eigenvalues: np.ndarray
    share: float

    def __str__(self) -> str:
        word = "saddle-focus" if np.iscomplex(self.eigenvalues).any() else "saddle"
        values = ", ".join(_shortly(value) for value in np.sort_complex(self.eigenvalues))
        return f"the {word} at {_place(self.place)} with eigenvalues {values}"


@dataclass(frozen=True)
class InfinitePeriod:
    """The limit of cycles whose period grows without bound.

    Attributes
    ----------
    limit : Limit
    period : float
        Of the last cycle.
    slowest : ndarray, shape (d,)
        Where that is slowest.
    saddles : tuple of Saddle
        One of a homoclinic orbit, in the order in which they are passed of a heteroclinic cycle; else none.
    parameter, value : str, float
        Of a cycle that comes to rest: where it does, as 1 / T, continued in a straight line, has it.
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
                return f"saddle-node on the cycle: its period, {self.period:.6g} here, grows where it passes {_place(self.slowest)} without an equilibrium being there yet"
            case Limit.AT_REST:
                return (
                    f"the cycle comes to rest as a whole: its period, {self.period:.6g} here, grows as its speed falls everywhere, to a circle of equilibria at "
                    f"{self.parameter} = {self.value:.6g}, as of rotating waves whose rotation turns round there; begin beyond it to go on"
                )


def infinite_period(problem: CycleMesh, point: BorderPoint) -> InfinitePeriod:
    """What the cycles of a branch become whose period grows without bound towards a point."""
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
    """The last cycle of a branch, and how it changes along it: x, rates and change `moved` at the nodes, T and T'."""

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
        """d log(largest speed) / d log(period) along the branch; zero where the period does not change."""
        if not self.growth:
            return 0.0
        field, k = self.problem.field, int(np.argmax(self.speeds))
        x, rate = self.x[k : k + 1], self.rates[k] / self.units
        change = field.jacobian(x, self.p)[0] @ self.moved[k] + field.slope(x, self.p)[0] * self.tangent[-1]
        return float(rate @ (change / self.units) / (rate @ rate) * self.period / self.growth)

    def saddles(self) -> tuple[Saddle, ...]:
        """The equilibria with stable and unstable directions beside which the cycle stays longer and longer, in order along it, the one with the largest share first."""
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
            first, last = _run((np.abs(x - place) <= FAR * sizes).all(axis=1), k)
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
        """How the times change along the branch at which the cycle passes the planes across its motion at the nodes, that of one round last."""
        problem = self.problem
        f, moved = self.rates / problem.node_scale, self.moved / problem.node_scale
        lengths = self.growth * self.widths + self.period * self.tangent[:-1][problem.held]
        delays = mesh.node_places(problem.rule, lengths) - (f * moved).sum(axis=1) / np.maximum(
            (f * f).sum(axis=1), TINY
        )
        return np.append(delays, self.growth)


def _run(near: np.ndarray, k: int) -> tuple[int, int]:
    """First and last node of those round node k, on the closed cycle, that are near an equilibrium; the first before and behind it that are not."""
    away = np.flatnonzero(~near)
    if not len(away):
        return 0, len(near) - 1
    ahead = away[np.searchsorted(away, k) % len(away)]
    return int(away[np.searchsorted(away, k) - 1]), int(ahead)


def _place(x: np.ndarray) -> str:
    return f"({', '.join(f'{v:.6g}' for v in x)})"


def _shortly(value: complex) -> str:
    return f"{value.real:.4g}" if value.imag == 0.0 else f"{value:.4g}"


def nearby_equilibrium(
    problem: CycleMesh, start: np.ndarray, p: float, sizes: np.ndarray
) -> np.ndarray | None:
    """The equilibrium to which Newton's method leads from a point of a cycle of such sizes; None where that is far away, or none."""
    least = problem.flow.settings.rounded
    y = problem.field.rest(start, p, sizes, least, FAR)
    return None if y is None else np.where(np.abs(y) > least * sizes, y, 0.0)
