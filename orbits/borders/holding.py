"""Solutions of a new word in which what vanishes at a border has a given size."""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from orbits.contacts.changes import Change, Grows, What
from orbits.contacts.letters import STICK
from orbits.flows.solving import newton
from orbits.protocol import CycleProblem
from orbits.settings import BORDERING, GROWING, SOLVING


def parameter_unit(problem: CycleProblem, p: float) -> float:
    """What changes of the parameter near p are compared with: its own size, or where it started."""
    return max(abs(p), abs(problem.equations.began)) or 1.0


class Held(NamedTuple):
    """A solution in which what grows beyond the border has a given size."""

    u: np.ndarray
    p: float
    tangent: np.ndarray
    size: float


class Growing(NamedTuple):
    """What grows from nothing beyond a border at p: in orbits with a new word, at one of its events, by a change."""

    problem: CycleProblem
    first: int
    change: Change
    p: float

    def climb(self, guess: np.ndarray, sizes: tuple[float, ...]) -> list[Held]:
        """Solve with it held at each of the sizes in turn, as long as that converges."""
        found: list[Held] = []
        u, q = guess, self.p
        for wanted in sizes:
            held = self.hold(u, q, wanted)
            if held is None:
                break
            found.append(held)
            u, q = held.u, held.p
        return found

    def outwards(self, found: list[Held]) -> Iterator[Held]:
        """The solutions found from small to large, and on to larger sizes."""
        yield from found[-2::-1]
        held: Held | None = found[0]
        while held is not None and held.size < GROWING.first:
            held = self.hold(held.u, held.p, min(10.0 * held.size, GROWING.first))
            if held is not None:
                yield held

    def hold(self, guess: np.ndarray, q: float, wanted: float) -> Held | None:
        """Solve with it held at a size; None where there is no such solution near the border."""
        other, first, change, p = self
        size = other.dimension
        n = size // other.length
        border = np.zeros(size + 1)
        u, here, following = guess.copy(), first * n, (first + 1) * n % size
        if change.grows is Grows.GAP and not other.forced:
            border[here], u[here] = 1.0, wanted
        elif change.grows is Grows.GAP:
            border[here], border[following] = -1.0, 1.0
            if change.what is What.CROSSINGS_APPEAR:
                u[here] = 0.5 * (u[here] + u[following] - wanted)
                u[following] = u[here] + wanted
            elif change.start == change.stop:  # the later event stays: friction gives way there
                u[here] = u[following] - wanted
            else:
                u[following] = u[here] + wanted
        else:
            near = BORDERING.together * parameter_unit(other, p)
            speed, slopes, by_parameter, push = other.equations.approach(u, q, first, near)
            border[here : here + n], border[size] = slopes, by_parameter
            u[here : here + n] += push * (wanted - speed) / float(slopes @ push)
            if (
                len(change.events) > 1
                and other.word.letter(first + 1).kind == STICK
                and abs(speed) > BORDERING.together
            ):  # it comes to rest the sooner the slower it is
                clock = here if not other.forced else following
                since = u[following] - u[here] if other.forced else u[here]
                u[clock] += since * (wanted / speed - 1.0)
        u, q, residual, tangent = newton(other.equations, u, q, border)
        if not residual < SOLVING.residual:
            return None
        return Held(u, q, tangent, wanted)
