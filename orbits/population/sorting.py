"""The starts of one census, sorted by the motions they reach."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from contvines.shared.motions import Motion
from orbits.attractors.motion import Form, Problem, alike


class Sorting:
    """Motions, each once, and which start reaches which.

    Attributes
    ----------
    motions : list of Motion
    index : int array (n,)
        Which of them each start reaches; -1 while that is not known.
    mirrored : bool array (n,)
        Whether it reaches the mirror image of that motion.
    """

    def __init__(self, count: int, parameter: str, p: float) -> None:
        self.parameter, self.p = parameter, p
        self.motions: list[Motion[Problem]] = []
        self.index = np.full(count, -1)
        self.mirrored = np.zeros(count, dtype=bool)
        self._forms: list[Form | None] = []

    def sort(
        self, reached: Callable[[int, Sorting], None]
    ) -> tuple[list[Motion[Problem]], np.ndarray, np.ndarray]:
        """Motions in the order of their first start, then `index` and `mirrored`; `reached` says of a start, and perhaps of others with it, which it reaches."""
        for i in range(len(self.index)):
            if self.index[i] < 0:
                reached(i, self)
        first = [int(np.flatnonzero(self.index == k)[0]) for k in range(len(self.motions))]
        order = sorted(range(len(first)), key=first.__getitem__)
        place = np.argsort(order)
        return [self.motions[k] for k in order], place[self.index], self.mirrored

    def plain(
        self,
        members: np.ndarray | int,
        kind: str,
        exponent: float = np.nan,
        error: float = np.nan,
        state: np.ndarray | None = None,
    ) -> None:
        """These starts reach the motion of a kind that is not distinguished any further."""
        for k, motion in enumerate(self.motions):
            if motion.kind == kind and self._forms[k] is None and not motion.word:
                return self.assign(members, k)
        self.assign(members, self._add(Motion(kind, exponent=exponent, error=error, state=state), None))

    def place(self, motion: Motion[Problem]) -> int:
        """The number of a motion, which is put on the list if it is a new one."""
        form = self._form(motion)
        for k, known in enumerate(self.motions):
            other = self._forms[k]
            one = alike(form, other) if form is not None and other is not None else form is other
            if one and known.kind == motion.kind and known.periods == motion.periods:
                return k
        return self._add(motion, form)

    def _add(self, motion: Motion, form: Form | None) -> int:
        self.motions.append(motion)
        self._forms.append(form)
        return len(self.motions) - 1

    def _form(self, motion: Motion[Problem]) -> Form | None:
        """By which a motion is known; None of one without a word."""
        if motion.problem is None or motion.u is None:
            return None
        return motion.problem.canonical(motion.u, self.p)

    def assign(self, members: np.ndarray | int, k: int, mirrored: np.ndarray | bool = False) -> None:
        """These starts, as far as they are free, reach motion k, or its mirror image."""
        here = np.zeros(len(self.index), dtype=bool)
        here[members] = True
        here &= self.index < 0
        self.mirrored[here] = np.broadcast_to(mirrored, here.shape)[here]
        self.index[here] = k
