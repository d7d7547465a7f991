"""The rows of a sweep: the CSV file, and beside it the journal from which an unfinished sweep resumes."""

from __future__ import annotations

import csv
import json
import math
from dataclasses import dataclass, field
from pathlib import Path
from tempfile import gettempdir
from typing import TYPE_CHECKING, Any

from ..graph.table import with_unit
from ..shared import row_journal
from ..shared.files import digest_of
from ..shared.motions import BAND, SILENT
from .compose import machine
from .study_data import Study

if TYPE_CHECKING:
    from orbits.attractors.sweeping import SweepRow

FIRST = ("value", "direction", "attractor", "word", "periods", "impacts")
LAST = ("modulation", "symmetric", "nodes")


@dataclass(frozen=True)
class Kept:
    """A row of a sweep: one value of the parameter and the motion there.

    Attributes
    ----------
    cells : list of str
        The row of the CSV file.
    attractor : str
        Kind of the motion; `sliding` is distinguished from `periodic`.
    recurrent : bool
        Whether the motion recurs.
    modulation : str
        Its modulation; see `contvines.shared.motions`.
    band : list of float
        Lowest, mean and highest of the largest response per forcing period; empty without modulation.
    dots : list of float
        Numbers that a picture shows: the largest |q1|, or B at every impact (beginning with the first one of the word, if there is a word).
    state : list of float
        The final state, from which the next value continues.
    """

    cells: list[str]
    attractor: str
    recurrent: bool
    dots: list[float]
    state: list[float]
    modulation: str = ""
    band: list[float] = field(default_factory=list)

    @property
    def value(self) -> float:
        return float(self.cells[0])

    @property
    def word(self) -> str:
        return self.cells[3]

    @property
    def periods(self) -> int:
        return int(self.cells[4])


def kept(row: SweepRow, direction: str, names: list[str]) -> Kept:
    """Convert a row of `orbits.attractors.sweep`; `names` are the measures in the order of the CSV's columns."""
    found, guess = row.detail, row.detail.guess
    kind = "periodic" if row.attractor == "sliding" else row.attractor
    cells = [repr(row.value), direction, kind, row.word, str(row.periods), str(row.impacts)]
    for name in names:
        x = float(row.measures[name])
        cells.append(repr(x) if math.isfinite(x) or name not in (*BAND, SILENT) else "")
    nodes = "" if guess is None else json.dumps([[float(x) for x in node] for node in guess])
    cells += [row.modulation, str(int(found.symmetric)) if found.recurrent else "", nodes]
    band = [float(row.measures[name]) for name in BAND] if row.modulation else []
    return Kept(
        cells, row.attractor, found.recurrent, row.dots, [float(x) for x in found.state], row.modulation, band
    )


def rows_as_json(rows: list[Kept], study: Study) -> dict[str, Any]:
    """Return the content of the CSV ready for JSON, at full precision, and the share of the values with modulated motions, by kind."""
    names = measured_names(study)
    kinds = dict.fromkeys(row.modulation for row in rows if row.modulation)
    return {
        "parameter": study.parameter,
        "modulated": {kind: sum(row.modulation == kind for row in rows) / len(rows) for kind in kinds},
        "rows": [dict(zip((*FIRST, *names, *LAST), map(_read, row.cells))) for row in rows],
    }


def measured_names(study: Study) -> list[str]:
    """Return the names of the measures in the rows, in the order of the CSV's columns."""
    from orbits.attractors.attractor import measure_names

    return [name for name in measure_names(machine(study)) if name not in FIRST]


def _read(cell: str) -> object:
    """Convert a cell of the CSV to a JSON value."""
    try:
        return json.loads(cell)
    except ValueError:
        return cell or None


def journal_of(target: Path) -> Path:
    """Return the path of the journal of an unfinished sweep or survey."""
    return target.with_name(target.name + ".unfinished")


def refuse_another(target: Path, header: dict[str, str]) -> None:
    """Raise an error if the journal beside a file has rows of another study, which would be lost.

    Parameters
    ----------
    target : Path
        The result's file.
    header : dict
        First line of this study's journal.

    Raises
    ------
    ValueError
        If it has.
    """
    count = row_journal.rows_of_another(journal_of(target), header)
    if count:
        raise ValueError(
            f"{target}: here {count} rows of an {header['contvines']} of another study (or of this one before it "
            "was edited) are kept; --fresh sets them aside, -o gives another name."
        )


class Rows(row_journal.Rows[Kept]):
    """The rows of a sweep on disk, each written at once.

    The CSV file is for the user. The journal beside it (`FILE.csv.unfinished`) has the states, too; it is deleted when the sweep is finished.
    """

    def __init__(self, target: Path, study: Study, down: bool) -> None:
        self.target, self.names = target, measured_names(study)
        units = machine(study).units
        units = {"value": units.get(study.parameter), **units}
        self.heads = [with_unit(name, units.get(name)) for name in (*FIRST, *self.names, *LAST)]
        self.lasting = target.is_file() or not target.exists()  # a pipe or a terminal has no journal
        if not target.exists():
            journal_of(target).unlink(missing_ok=True)
        super().__init__(journal_of(target) if self.lasting else None, header_of(study, down), Kept)

    def __enter__(self) -> Rows:
        try:
            super().__enter__()
            self.table = self.target.open("w", newline="", encoding="utf-8")
        except OSError as error:
            super().__exit__()
            raise ValueError(
                f"{self.target}: cannot be written there ({error.strerror}); "
                f"choose another place with -o, for example -o {Path(gettempdir()) / self.target.name}."
            ) from None
        self._write(self.heads, *(row.cells for row in self.found))
        return self

    def keep(self, row: Kept) -> None:
        """Add a row and write it to both files."""
        self._write(row.cells)
        super().keep(row)

    def _write(self, *lines: list[str]) -> None:
        csv.writer(self.table).writerows(lines)
        self.table.flush()

    def __exit__(self, kind: object = None, *_: object) -> None:
        self.table.close()
        super().__exit__()
        if kind is None and self.path is not None:
            self.path.unlink(missing_ok=True)


def header_of(study: Study, down: bool) -> dict[str, str]:
    """Return the first line of a sweep's journal, with a digest of everything that determines its rows; equal for runs with equal results."""
    decides = {"study": study.describe(), "sweep": study.sweep.model_dump(), "down": down}
    return {"contvines": "unfinished sweep", "of": digest_of(decides)}
