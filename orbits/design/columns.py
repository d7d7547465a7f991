"""Read columns of measured numbers and their headings from a CSV file."""

from __future__ import annotations

import csv
from pathlib import Path

import numpy as np

from orbits.machines.base import ParameterError


def read_table(path: str | Path, columns: int) -> tuple[list[str], np.ndarray]:
    """Read the headings and the first `columns` columns of a CSV file.

    Empty lines and lines that begin with # are ignored. Cells may be separated by commas, tabs or semicolons; with semicolons, numbers may
    have decimal commas.

    Returns
    -------
    list of str
        Headings; empty if the file has none.
    float array (n, columns)

    Raises
    ------
    ParameterError
        If the file or one of its rows cannot be read; the message names the row.
    """
    path = Path(path)
    try:
        lines = path.read_text(encoding="utf-8-sig").splitlines()
    except (OSError, UnicodeDecodeError) as error:
        reason = getattr(error, "strerror", None) or "it is no text in UTF-8"
        raise ParameterError(
            f"{path}: cannot be read ({reason}); give a CSV with {_needed(columns)}"
        ) from None
    numbered = [(k, line) for k, line in enumerate(lines, 1) if line.strip() and not line.startswith("#")]
    parting = next((sign for sign in (";", "\t") if numbered and sign in numbered[0][1]), ",")
    heads: list[str] = []
    found: list[list[float]] = []
    for number, line in numbered:
        cells = [cell.strip() for cell in next(csv.reader([line], delimiter=parting))]
        try:
            row = [float(cell.replace(",", ".") if parting == ";" else cell) for cell in cells[:columns]]
        except ValueError:
            if not found and not heads:
                heads = cells
                continue
            raise ParameterError(
                f"{path}: row {number} holds {', '.join(cells[:columns])!r}, not {_needed(columns, 'number')}"
            ) from None
        if heads and len(cells) > len(heads):
            decimals = "; decimal commas need semicolons between the columns" if parting == "," else ""
            raise ParameterError(
                f"{path}: row {number} has {len(cells)} cells below {_needed(len(heads), 'head')}{decimals}"
            )
        if len(row) < columns:
            raise ParameterError(
                f"{path}: row {number} has {_needed(len(row))}; {_needed(columns)} are needed"
                if columns > 1
                else f"{path}: row {number} is empty"
            )
        found.append(row)
    if not found:
        raise ParameterError(f"{path}: there is no row of numbers; give {_needed(columns)}")
    return heads, np.array(found)


def _needed(count: int, noun: str = "column") -> str:
    return f"{count} {noun}{'' if count == 1 else 's'}"
