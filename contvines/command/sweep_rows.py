"""The rows of a sweep: the CSV, and beside it the journal from which an unfinished sweep goes on."""

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
    """One value of a sweep as it is kept.

    Attributes
    ----------
    cells : text of the CSV's columns.
    attractor : kind of the motion, `sliding` distinguished from `periodic`.
    recurrent : whether the motion recurs.
    modulation : how it is modulated; see `contvines.shared.motions`.
    band : lowest, mean and highest of its largest responses in each forcing period; empty where it has none.
    dots : what a picture shows: the largest |q1|, or B at every impact (from the word's first on, where there is one).
    state : state reached, from which the next value goes on.
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
    """A row of `orbits.attractors.sweep` as it is kept; `names` are the measures in the CSV's order."""
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
    """The CSV's content as JSON, numbers at full precision, and the share of the values at which the motion is modulated, by its kind."""
    names = measured_names(study)
    kinds = dict.fromkeys(row.modulation for row in rows if row.modulation)
    return {
        "parameter": study.parameter,
        "modulated": {kind: sum(row.modulation == kind for row in rows) / len(rows) for kind in kinds},
        "rows": [dict(zip((*FIRST, *names, *LAST), map(_read, row.cells))) for row in rows],
    }


def measured_names(study: Study) -> list[str]:
    """The measures of the rows, in the order of the CSV."""
    from orbits.attractors.attractor import measure_names

    return [name for name in measure_names(machine(study)) if name not in FIRST]


def _read(cell: str) -> object:
    """A cell of the CSV as JSON has it."""
    try:
        return json.loads(cell)
    except ValueError:
        return cell or None


def journal_of(target: Path) -> Path:
    """Where the rows of an unfinished sweep or survey are kept."""
    return target.with_name(target.name + ".unfinished")


def refuse_another(target: Path, header: dict[str, str]) -> None:
    """Refuse to lose the rows of an unfinished run of another study.

    Parameters
    ----------
    target : Path
    header : dict
        First line of this study's journal.

    Raises
    ------
    ValueError
    """
    count = row_journal.rows_of_another(journal_of(target), header)
    if count:
        raise ValueError(
            f"{target}: here {count} rows of an {header['contvines']} of another study (or of this one before it "
            "was edited) are kept; --fresh sets them aside, -o gives another name."
        )


class Rows(row_journal.Rows[Kept]):
    """The rows of a sweep on disk, each kept as soon as it is there.

    The CSV is for the user. The journal beside it (`FILE.csv.unfinished`) also has the states, and goes when the sweep is finished.
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
        """Write one more row."""
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
    """First line of a sweep's journal, with a digest of all that decides its rows: runs that must give the same CSV share it."""
    decides = {"study": study.describe(), "sweep": study.sweep.model_dump(), "down": down}
    return {"contvines": "unfinished sweep", "of": digest_of(decides)}
