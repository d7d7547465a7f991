"""Solutions of a new word in which what vanishes at a border has a given size."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from orbits.contacts.changes import Change, Grows
from orbits.contacts.letters import STICK
from orbits.protocol import CycleProblem
from orbits.words.alphabet import LEFT

NEAR = 1e-7  # margins this small vanish together


def parameter_unit(problem: CycleProblem, p: float) -> float:
    """What changes of the parameter near p are compared with: its own size, or where it started."""
    return max(abs(p), abs(problem.equations.began)) or 1.0


class Held(NamedTuple):
    """A solution in which what grows beyond the border has a given size."""

    u: np.ndarray
    p: float
    tangent: np.ndarray
    size: float


def climb(
    other: CycleProblem, guess: np.ndarray, first: int, change: Change, p: float, sizes: tuple[float, ...]
) -> list[Held]:
    """Solve with what grows beyond the border held at each of the sizes in turn, as long as that converges."""
    found: list[Held] = []
    u, q = guess, p
    for wanted in sizes:
        held = hold(other, u, q, first, change, p, wanted)
        if held is None:
            break
        found.append(held)
        u, q = held.u, held.p
    return found


def hold(
    other: CycleProblem, guess: np.ndarray, q: float, first: int, change: Change, p: float, wanted: float
) -> Held | None:
    """Solve with what grows beyond the border at p held at a size; None where there is no such solution near the border."""
    n, size = other.model.node, other.dimension
    kernels, work = other.equations.kernels, other.scratch
    step, tangent, border = np.empty(size + 1), np.empty(size + 1), np.zeros(size + 1)
    u, scale = guess.copy(), parameter_unit(other, p)
    if change.grows is Grows.GAP:
        border[first * n], border[(first + 1) * n] = -1.0, 1.0
        if change.start == change.stop:  # the later event stays: friction gives way there
            u[first * n] = u[(first + 1) * n] - wanted
        else:
            u[(first + 1) * n] = u[first * n] + wanted
    else:
        sign = 1.0 if other.word.letter(first).contact == LEFT else -1.0
        unit = other.equations.unit[first]  # the second entry of an impact's node is a speed
        node, near = u[first * n : (first + 1) * n] * unit, NEAR * scale
        cavity, slopes = other.model.cavity_speed(node, other.values(q))
        beside, _ = other.model.cavity_speed(node, other.values(q + near))
        own = float(unit[1])
        cavity, beside = cavity / own, beside / own
        border[first * n : (first + 1) * n] = -sign * slopes * unit / own
        border[first * n + 1] += sign
        border[size] = -sign * (beside - cavity) / near
        speed = sign * (float(u[first * n + 1]) - cavity)
        u[first * n + 1] += sign * (wanted - speed)
        if (
            len(change.events) > 1 and other.word.letter(first + 1).kind == STICK and abs(speed) > NEAR
        ):  # it comes to rest the sooner the slower it is
            u[(first + 1) * n] += (u[(first + 1) * n] - u[first * n]) * (wanted / speed - 1.0)
    residual, _, q_new = kernels.newton(other.data, u, q, work, border, step, tangent, 1e-12, 40)
    if not residual < 1e-10:
        return None
    return Held(u, float(q_new), tangent, wanted)
