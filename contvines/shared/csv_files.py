"""Tables of numbers and names as CSV files."""

from __future__ import annotations

import csv
from collections.abc import Iterable
from pathlib import Path


def write_csv(path: str | Path, head: Iterable[str], rows: Iterable[Iterable[object]]) -> None:
    """A line of heads, then one for each row; an OSError where the file cannot be written."""
    with Path(path).open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file)
        writer.writerow(head)
        writer.writerows(rows)
