"""Matrices of a structure, and Rubin's reduction: own modes up to a frequency, and static deflections under forces at the contacts.

Degrees of freedom with forces and contacts remain coordinates. Source: S. Rubin, Improved component-mode representation for structural
dynamic analysis, AIAA Journal 13 (1975) 995.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from scipy.linalg import eigh

from orbits.machines.parameters import ParameterError
from orbits.settings import FORMULAS

WHOLE = 8  # largest number of degrees of freedom without reduction
GRID = 200  # frequencies at which receptances are compared, besides the natural frequencies


@dataclass(frozen=True, eq=False)
class Reduced:
    """A structure in few coordinates.

    Attributes
    ----------
    mass, damping, stiffness : float array (k, k)
    kept : tuple of int
        Degrees of freedom, from 0, that are the first coordinates; modes follow.
    size : int
        Degrees of freedom of the whole structure.
    error : float
        Largest relative difference of the receptances (displacements per force, at the kept ones) up to `highest`; 0 if nothing is reduced.
    highest : float
        Frequency, radians per unit of time.
    """

    mass: np.ndarray
    damping: np.ndarray
    stiffness: np.ndarray
    kept: tuple[int, ...]
    size: int
    error: float
    highest: float

    @property
    def sentence(self) -> str:
        """A sentence on the reduction and its accuracy."""
        if len(self.mass) == self.size:
            return f"all {self.size} degrees of freedom are kept"
        modes = len(self.mass) - len(self.kept)
        return (
            f"{self.size} degrees of freedom are reduced to {len(self.kept)}, those with forces and contacts, and {modes} "
            f"mode{'' if modes == 1 else 's'}; receptances there differ by at most {100.0 * self.error:.2g} % up to {self.highest:.4g} rad/s"
        )


def reduced(
    mass: np.ndarray,
    damping: np.ndarray,
    stiffness: np.ndarray,
    kept: Sequence[int],
    highest: float,
    accuracy: float,
) -> Reduced:
    """Reduce a structure to as few modes as the accuracy permits.

    Parameters
    ----------
    mass, damping, stiffness : float array (n, n)
    kept : sequence of int
        Degrees of freedom, from 0, that must remain.
    highest, accuracy : float
        Highest frequency at which receptances are compared, and their largest relative difference.

    Raises
    ------
    ParameterError
        If the mass matrix is not positive definite.
    """
    size = len(mass)
    if np.linalg.eigvalsh(mass)[0] <= 0.0:
        raise ParameterError(
            "mass: the matrix is not positive definite; every degree of freedom needs a mass"
        )
    if size <= WHOLE or len(kept) >= size:
        return Reduced(mass, damping, stiffness, tuple(range(size)), size, 0.0, highest)
    squares, modes = eigh(stiffness, mass)
    shift = (
        highest**2 if squares[0] <= FORMULAS.zero * squares[-1] else 0.0
    )  # a free structure has no static deflection
    bent = np.linalg.solve(stiffness + shift * mass, np.eye(size)[:, kept])
    frequencies = np.sqrt(np.maximum(squares, 0.0))
    steady = np.linspace(0.0, highest, GRID + 1)[1:]
    places = np.unique(np.concatenate([steady, frequencies[(frequencies > 0.0) & (frequencies <= highest)]]))
    matrices, ends = (mass, damping, stiffness), np.asarray(kept, dtype=int)
    true = np.array([_receptance(matrices, w, ends) for w in places])
    scale = np.linalg.norm(true, axis=(1, 2))
    for count in range(int(np.searchsorted(frequencies, highest, side="right")), size - len(kept)):
        basis = _basis(mass, modes[:, :count], bent, ends)
        small = tuple(basis.T @ matrix @ basis for matrix in matrices)
        response = np.array([_receptance(small, w, np.arange(len(kept))) for w in places])
        error = float((np.linalg.norm(response - true, axis=(1, 2)) / scale).max())
        if error <= accuracy:
            return Reduced(small[0], small[1], small[2], tuple(int(i) for i in kept), size, error, highest)
    return Reduced(mass, damping, stiffness, tuple(range(size)), size, 0.0, highest)


def _basis(mass: np.ndarray, modes: np.ndarray, bent: np.ndarray, kept: np.ndarray) -> np.ndarray:
    """Return directions (n, k): each of the first moves one kept degree of freedom by 1, the others move none of them."""
    remainder = bent - modes @ (modes.T @ (mass @ bent))
    span = np.hstack([modes, remainder / np.linalg.norm(remainder, axis=0)])
    rows = span[kept]
    unmoved = np.linalg.svd(rows)[2][len(kept) :].T
    inside = span @ unmoved
    return np.hstack(
        [span @ np.linalg.pinv(rows), inside / np.sqrt(np.sum(inside * (mass @ inside), axis=0))]
    )


def _receptance(matrices: Sequence[np.ndarray], omega: float, at: np.ndarray) -> np.ndarray:
    """Return displacements of these coordinates under unit forces on them."""
    m, c, k = matrices
    return np.linalg.solve(k + 1j * omega * c - omega**2 * m, np.eye(len(m))[:, at])[at]


Given = str | np.ndarray | Sequence[Sequence[float]]
MOST = 3000  # largest number of degrees of freedom: the reduction uses dense matrices


def matrix(name: str, given: Given, folder: Path | None = None) -> np.ndarray:
    """Return a square matrix, shape (n, n).

    Parameters
    ----------
    name : str
        "mass", "damping" or "stiffness": for messages, and as the name of the variable in a MATLAB file.
    given : nested list, array, or str
        ``"mass.csv"``, ``"mass.txt"`` (numbers separated by commas, semicolons or blanks) or ``"model.mat:M"``.
    folder : Path, optional
        Folder of the files.

    Raises
    ------
    ParameterError
        If it cannot be read, or is no finite symmetric matrix.
    """
    label = f"{name} = {given!r}" if isinstance(given, str) else name
    try:
        found = np.asarray(_read(name, given, folder) if isinstance(given, str) else given, dtype=float)
    except (TypeError, ValueError) as error:
        raise ParameterError(
            f"{label}: {error}; give rows of numbers, [[2, -1], [-1, 2]], or a file"
        ) from None
    except OSError as error:
        raise ParameterError(f"{label}: cannot be read ({error.strerror or error})") from None
    if found.ndim != 2 or found.shape[0] != found.shape[1] or not found.size:
        raise ParameterError(f"{label}: its shape is {found.shape}; expected a square matrix")
    if len(found) > MOST:
        raise ParameterError(
            f"{label}: {len(found)} degrees of freedom; at most {MOST} are allowed: reduce it beforehand"
        )
    if not np.isfinite(found).all():
        raise ParameterError(f"{label}: it has entries that are not finite")
    if np.abs(found - found.T).max() > FORMULAS.same * np.abs(found).max():
        raise ParameterError(f"{label}: it is not symmetric; a structure's matrices are")
    return 0.5 * (found + found.T)


def _read(name: str, text: str, folder: Path | None) -> Sequence[Sequence[float]] | np.ndarray:
    file, _, variable = text.partition(":")
    path = Path(file) if folder is None else folder / file
    if path.suffix != ".mat":
        lines = path.read_text(encoding="utf-8").replace(",", " ").replace(";", " ").splitlines()
        return [[float(part) for part in line.split()] for line in lines if line.split("#")[0].strip()]
    from scipy.io import loadmat
    from scipy.sparse import issparse

    arrays = {key: value for key, value in loadmat(path).items() if not key.startswith("__")}
    if not variable and len(arrays) > 1:
        raise ValueError(f"the file has {', '.join(arrays)}: name one, {file}:{next(iter(arrays))}")
    value = arrays.get(variable or next(iter(arrays), ""))
    if value is None:
        raise ValueError(f"the file has no {variable or name!r}; it has {', '.join(arrays) or 'nothing'}")
    return value.toarray() if issparse(value) else value  # type: ignore[union-attr]
