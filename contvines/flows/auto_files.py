"""Solutions of AUTO-07p read from its files s.NAME (fort.8): cycles to start from."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np


@dataclass(frozen=True)
class AutoSolution:
    """A labelled solution of AUTO-07p.

    Attributes
    ----------
    branch, point, label : int
    kind : int
        AUTO's number of the type: 2 and 5 folds, 3 Hopf points, 7 period doublings, 9 ends.
    times : ndarray, shape (n,)
        In units of the period; a single 0 for an equilibrium.
    states : ndarray, shape (n, d)
    parameters : ndarray, shape (m,)
        PAR(1) first.
    """

    branch: int
    point: int
    label: int
    kind: int
    times: np.ndarray
    states: np.ndarray
    parameters: np.ndarray

    def __repr__(self) -> str:
        n, d = self.states.shape
        return f"AutoSolution(label {self.label}, branch {self.branch}, type {self.kind}: {d} states at {n} times, {len(self.parameters)} parameters)"

    @property
    def period(self) -> float:
        """PAR(11), where AUTO keeps the period of a cycle.

        Raises
        ------
        ValueError
            If the file has fewer parameters.
        """
        if len(self.parameters) < 11:
            raise ValueError(
                f"the solution with label {self.label} has {len(self.parameters)} parameters, so no period (PAR(11)); take another label"
            )
        return float(self.parameters[10])


def read_auto(path: str | Path) -> list[AutoSolution]:
    """The solutions of a file s.NAME of AUTO-07p.

    A cycle is gone on with by ``flow.cycle(solution.times * solution.period, solution.states, mu=solution.parameters[0])``.

    Parameters
    ----------
    path : path

    Returns
    -------
    list of AutoSolution

    Raises
    ------
    ValueError
        If the file cannot be read, or is no file s.NAME of AUTO-07p.
    """
    try:
        text = Path(path).read_text(encoding="utf-8")
        return list(_solutions(text.splitlines()))
    except OSError as error:
        raise ValueError(f"{path}: cannot be read ({error.strerror})") from None
    except (ValueError, IndexError, UnicodeDecodeError):
        raise ValueError(
            f"{path}: this is no file s.NAME of AUTO-07p (fort.8); give the name of one"
        ) from None


def _solutions(lines: list[str]) -> Iterator[AutoSolution]:
    """Solutions one after the other: a line of whole numbers says how many lines and numbers follow."""
    k = 0
    while k < len(lines):
        head = [int(word) for word in lines[k].split()]
        branch, point, kind, label, _, _, points, size, rows = head[:9]
        count = head[11]
        numbers = " ".join(lines[k + 1 : k + 1 + rows]).split()
        if k + rows >= len(lines):
            raise ValueError
        k += 1 + rows
        if points == 0:  # the last line of some files only says how far labels have come
            continue
        values = np.array([_number(word) for word in numbers])
        along = values[: points * size].reshape(points, size)
        parameters = values[len(values) - count :]
        yield AutoSolution(branch, point, label, kind, along[:, 0].copy(), along[:, 1:].copy(), parameters)


def _number(word: str) -> float:
    """A number as Fortran writes it: the letter of its exponent is D, or is missing where that has three digits."""
    try:
        return float(word.replace("D", "E").replace("d", "e"))
    except ValueError:
        sign = max(word.rfind("+"), word.rfind("-"))
        return float(f"{word[:sign]}E{word[sign:]}")
