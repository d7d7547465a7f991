"""Watching a branch: sign changes in chunks of points, each located."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from ..continuation.chunk import Chunk
from ..continuation.engine import Solved, parameter_unit
from .dips import below_zero, lengths_of, suspects
from .examine import FLAT, MARGIN, Examiner, Located, changes
from .functions import counts
from .segment import Segment


class Watch(Examiner):
    """What to look for along a branch.

    Parameters
    ----------
    engine : Engine
    user_functions : mapping of name to function, optional
        See :func:`contvines.events.functions.user_function`.
    """

    def look(self, chunk: Chunk, skip: int = 0, real: bool = True) -> list[Located]:
        """All special points on a chunk, in order; what lies behind a border or a meeting is left out.

        Parameters
        ----------
        chunk : Chunk
        skip : int
            Leave out this many segments at the beginning (at a branch point).
        real : bool
            Whether the branch has positive margins; on a virtual one the return to positive margins is the border.
        """
        n = len(chunk)
        if n < 2:
            return []
        engine = self.engine
        slope = chunk.tangents[:, -1]
        steep = np.abs(slope) > FLAT * parameter_unit(engine.within, float(chunk.values[0]))
        fold = changes(slope) & (steep[:-1] | steep[1:])
        chunk = replace(chunk, signs=without_zeros(chunk.signs))
        turned = changes(chunk.signs)
        numbers = counts(engine.spectrum(chunk.rows), self.kind)
        jumps = numbers[:-1] != numbers[1:]
        changed = jumps[:, 0] | jumps[:, 1] | jumps[:, 2]
        interesting = fold | turned | changed
        if engine.problem.n_margins:
            negative = engine.smallest_margin(chunk.rows) < MARGIN
            border = (negative[1:] & ~negative[:-1]) if real else (negative[:-1] & ~negative[1:])
            if real and negative[0] and not negative[1:].all():
                border |= negative[1:]
            interesting |= border
        meets = np.zeros(n - 1, dtype=bool)
        # a cycle is known from any of its nodes: a few unknowns tell whether it is its own image
        columns = 16 if self.kind == "map" else None
        for test in self.symmetries:
            part = test.part(chunk.points, columns)
            size = np.abs(part).max(axis=1)
            far = (size[:-1] > 1e-6) & (size[1:] > 1e-6)
            meets |= far & (np.einsum("ij,ij->i", part[:-1], part[1:]) < 0.0)
        interesting |= meets
        user_values = {name: f(chunk.points, chunk.values) for name, f in self.users.items()}
        for values in user_values.values():
            interesting |= changes(values)
        splits = self._dips(chunk, real)
        interesting[list(splits)] = True
        interesting[:skip] = False
        events: list[Located] = []
        for i in np.flatnonzero(interesting):
            i = int(i)
            segment = Segment(engine, chunk.solved(i), chunk.solved(i + 1))
            if i in splits:
                s, middle = splits[i]
                plain = Located(s, "plain", 0, middle, (np.nan, np.nan), 0.0)
                found = [*self.both(segment, s, middle, real), plain]
            else:
                found = self.examine(segment, real=real)
            found += self.examine_users(
                segment, {name: values[i : i + 2] for name, values in user_values.items()}
            )
            bracket = (float(chunk.values[i]), float(chunk.values[i + 1]))
            found = [e._replace(position=i + e.position, bracket=bracket) for e in found]
            found.sort(key=lambda e: e.position)
            stop = next((e for e in found if e.kind == "meets" or e.note == "border"), None)
            if stop is not None:
                # at a vanishing stick or flight p is stationary: the fold at the border itself is the border
                found = [e for e in found if e is stop or self._apart(e, stop)]
                events = [e for e in events if self._apart(e, stop)]
            for event in found:
                events.append(event)
                if event.kind == "meets" or event.note == "border":
                    return events
        return events

    def _dips(self, chunk: Chunk, real: bool) -> dict[int, tuple[float, Solved]]:
        """Segments inside which the smallest margin is negative, or stability lost, though not at their ends."""
        engine = self.engine
        tests: list[tuple[np.ndarray, Callable[[np.ndarray], np.ndarray]]] = []
        if engine.problem.n_margins and real:
            tests.append((engine.smallest_margin(chunk.rows), engine.smallest_margin))
        if self.kind != "none" and engine.m:
            tests.append((self._damping(chunk.rows), self._damping))
        found: dict[int, tuple[float, Solved]] = {}
        lengths = lengths_of(engine, chunk.points, chunk.values) if tests else np.zeros(0)
        for values, test in tests:
            for i in suspects(lengths, values):
                for k in (int(i) - 1, int(i)):
                    segment = Segment(engine, chunk.solved(k), chunk.solved(k + 1))
                    split = below_zero(segment, lambda point, test=test: float(test(point.row)))
                    if split is not None and k not in found:
                        found[k] = split
        return found

    def _damping(self, rows: np.ndarray) -> np.ndarray:
        """Positive where stable: minus the logarithm of the largest multiplier (minus the largest real part)."""
        spectrum = self.engine.spectrum(rows)
        if self.kind == "flow":
            return -spectrum.real.max(axis=-1)
        with np.errstate(divide="ignore"):
            return -np.log(np.abs(spectrum).max(axis=-1))

    def _apart(self, event: Located, stop: Located) -> bool:
        engine, a, b = self.engine, event.point, stop.point
        return engine.norm(engine.join(a.u - b.u, a.p - b.p)) > 1e-5


def without_zeros(signs: np.ndarray) -> np.ndarray:
    """Signs in which a zero (a point that is singular to roundoff) has taken the sign before it."""
    if np.all(signs):
        return signs
    signs = signs.copy()
    for i in np.flatnonzero(signs == 0.0):
        others = signs[i + 1 :][signs[i + 1 :] != 0.0]
        signs[i] = signs[i - 1] if i > 0 else (others[0] if len(others) else 1.0)
    return signs
