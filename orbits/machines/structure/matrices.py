"""Matrices of a structure: numbers, or a text, CSV or MATLAB file."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from orbits.machines.parameters import ParameterError
from orbits.settings import FORMULAS

Given = str | np.ndarray | Sequence[Sequence[float]]
MOST = 3000  # degrees of freedom: the reduction works with full matrices


def matrix(name: str, given: Given, folder: Path | None = None) -> np.ndarray:
    """A square matrix, shape (n, n).

    Parameters
    ----------
    name : str
        "mass", "damping" or "stiffness": for refusals, and of the variable in a MATLAB file that holds several.
    given : nested list, array, or str
        ``"mass.csv"``, ``"mass.txt"`` (numbers apart by commas, semicolons or blanks) or ``"model.mat:M"``.
    folder : Path, optional
        Where files lie.

    Raises
    ------
    ParameterError
        If it cannot be read, or is no finite symmetric matrix.
    """
    where = f"{name} = {given!r}" if isinstance(given, str) else name
    try:
        found = np.asarray(_read(name, given, folder) if isinstance(given, str) else given, dtype=float)
    except (TypeError, ValueError) as error:
        raise ParameterError(
            f"{where}: {error}; give rows of numbers, [[2, -1], [-1, 2]], or a file"
        ) from None
    except OSError as error:
        raise ParameterError(f"{where}: cannot be read ({error.strerror or error})") from None
    if found.ndim != 2 or found.shape[0] != found.shape[1] or not found.size:
        raise ParameterError(f"{where}: its shape is {found.shape}; expected a square matrix")
    if len(found) > MOST:
        raise ParameterError(
            f"{where}: {len(found)} degrees of freedom; at most {MOST} are allowed: reduce it beforehand"
        )
    if not np.isfinite(found).all():
        raise ParameterError(f"{where}: it has entries that are not finite")
    if np.abs(found - found.T).max() > FORMULAS.same * np.abs(found).max():
        raise ParameterError(f"{where}: it is not symmetric; a structure's matrices are")
    return 0.5 * (found + found.T)


def _read(name: str, text: str, folder: Path | None) -> Sequence[Sequence[float]] | np.ndarray:
    file, _, variable = text.partition(":")
    path = Path(file) if folder is None else folder / file
    if path.suffix != ".mat":
        lines = path.read_text(encoding="utf-8").replace(",", " ").replace(";", " ").splitlines()
        return [[float(part) for part in line.split()] for line in lines if line.split("#")[0].strip()]
    from scipy.io import loadmat
    from scipy.sparse import issparse

    held = {key: value for key, value in loadmat(path).items() if not key.startswith("__")}
    if not variable and len(held) > 1:
        raise ValueError(f"the file has {', '.join(held)}: name one, {file}:{next(iter(held))}")
    value = held.get(variable or next(iter(held), ""))
    if value is None:
        raise ValueError(f"the file has no {variable or name!r}; it has {', '.join(held) or 'nothing'}")
    return value.toarray() if issparse(value) else value  # type: ignore[union-attr]
