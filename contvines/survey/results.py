"""Results of a survey: outcomes over a grid and its samples, as arrays, NetCDF and CSV."""

from __future__ import annotations

import hashlib
import html
import io
import json
import os
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any, Unpack

import numpy as np

from ..continuation.settings import hinted
from ..graph.table import with_unit
from ..journal import Resumable
from ..shared.figures import PanelOptions
from ..shared.files import write_csv
from ..shared.numbers import figures
from ..shared.on_demand import needed
from ..text_table import Table, titled
from .outcomes import LEAST_SHARE, OF_ALL
from .plan import Plan, PlanError
from .work import NOT_YET, Row

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from xarray import Dataset


@hinted
@dataclass(frozen=True, eq=False, repr=False)
class Survey(Resumable):
    """The outcomes of all systems of a plan.

    Attributes
    ----------
    plan : Plan
    columns : dict
        Outcome by name, each an array of the plan's shape; ``covered`` is always among them. nan where a system failed or lacks the outcome.
    notes : ndarray of str
        For each system the reason of its failure, or the gaps in its results; empty if its stable motions cover the whole interval.
    units : dict
        Units of parameters and outcomes by name.
    about : dict
        Description of the survey, JSON-able.
    notation : dict
        Axis labels by name of parameter or outcome; other names are shown as they are.
    """

    plan: Plan
    columns: dict[str, np.ndarray]
    notes: np.ndarray
    units: dict[str, str] = field(default_factory=dict)
    about: dict[str, Any] = field(default_factory=dict)
    notation: dict[str, str] = field(default_factory=dict)

    @classmethod
    def of(
        cls,
        plan: Plan,
        rows: Sequence[Row],
        units: dict[str, str],
        about: dict[str, Any],
        notation: dict[str, str] | None = None,
    ) -> Survey:
        """Make a survey from the rows of its systems, in any order; arguments as the attributes."""
        ordered = sorted(rows, key=lambda row: row.index)
        names = dict.fromkeys(name for row in ordered for name in row.columns)
        columns = {}
        for name in names:
            values = np.full(len(plan), np.nan)
            for row in ordered:
                values[row.index] = row.columns.get(name, np.nan)
            columns[name] = values.reshape(plan.shape)
        notes = np.full(len(plan), "", dtype=object)
        for row in ordered:
            notes[row.index] = row.note
        listed = (*plan.names, *columns)
        shown_units, labels = (
            {name: table[name] for name in listed if table.get(name)} for table in (units, notation or {})
        )
        return cls(plan, columns, notes.reshape(plan.shape), shown_units, about, labels)

    def __getitem__(self, name: str) -> np.ndarray:
        if name in self.columns:
            return self.columns[name]
        raise KeyError(f"the survey has no outcome {name!r}; it has {', '.join(self.columns)}")

    @property
    def lost(self) -> np.ndarray:
        """Whether each system has no outcome at all (it failed, or was not computed); bool array of the plan's shape."""
        numbers = [np.isfinite(values) for values in self.columns.values()]
        return (self.notes != "") & ~np.any(np.array(numbers).reshape(-1, *self.plan.shape), axis=0)

    @property
    def failed(self) -> int:
        """Number of systems that failed."""
        return int(np.count_nonzero(self.lost)) - self.waiting

    @property
    def waiting(self) -> int:
        """Number of systems that an interrupted survey has not computed yet."""
        return int(np.count_nonzero(self.notes == NOT_YET))

    @property
    def partly(self) -> int:
        """Number of systems with gaps in their results, which their notes describe."""
        return int(np.count_nonzero(self.notes != "")) - self.failed - self.waiting

    def known(self, outcome: str, covered: float = LEAST_SHARE) -> np.ndarray:
        """Return an outcome, with nan where it is only a bound.

        Outcomes about all motions together (`contvines.survey.outcomes.OF_ALL`), such as the peak, are bounds if the known stable
        responses do not cover the interval.

        Parameters
        ----------
        outcome : str
            Name of the outcome.
        covered : float
            Smallest share of the interval that the known responses must cover.

        Returns
        -------
        float array of the plan's shape
        """
        values = self[outcome]
        if outcome not in OF_ALL or "covered" not in self.columns:
            return values
        return np.where(self["covered"] >= covered, values, np.nan)

    def to_xarray(self):
        """Return an `xarray.Dataset` with a variable per outcome over the plan's dimensions, units, and the systems' notes."""
        xarray = needed("xarray", "tables")

        dims = self.plan.dimensions
        described = {
            name: {
                key: table[name]
                for key, table in (("units", self.units), ("long_name", self.notation))
                if name in table
            }
            for name in (*self.plan.names, *self.columns)
        }
        variables: dict[str, Any] = {
            name: (dims, values, described[name]) for name, values in self.columns.items()
        }
        variables["note"] = (
            dims,
            self.notes.astype(str),
            {"long_name": "why the system failed, or what is not known of it"},
        )
        coords: dict[str, Any] = {
            name: (name, values, described[name]) for name, values in self.plan.axes.items()
        }
        if self.plan.samples:
            coords["sample"] = ("sample", np.arange(self.plan.shape[-1], dtype=np.int32))
            coords |= {
                name: ("sample", values, described[name]) for name, values in self.plan.samples.items()
            }
        return xarray.Dataset(variables, coords, {"about": json.dumps(self.about, sort_keys=True)})

    def save(self, path: str | Path) -> None:
        """Write a NetCDF file with a digest, and a CSV file with the same numbers beside it; an existing NetCDF file is replaced atomically."""
        path = Path(path)
        write(self.to_xarray(), path)
        self.to_csv(path.with_suffix(".csv"))

    def to_csv(self, path: str | Path) -> None:
        """Write a CSV file with one row per system: its parameters, its outcomes, its note."""
        names = (*self.plan.names, *self.columns)
        rows, flat = [], [values.ravel() for values in self.columns.values()]
        for i, values in enumerate(self.plan.systems()):
            cells = [repr(values[name]) for name in self.plan.names]
            cells += [repr(float(column[i])) if np.isfinite(column[i]) else "" for column in flat]
            rows.append([*cells, self.notes.ravel()[i]])
        write_csv(path, [*(with_unit(name, self.units.get(name)) for name in names), "note"], rows)

    def plot(self, outcome: str | None = None, **options: Unpack[PanelOptions]) -> Figure:
        """Plot an outcome: a curve over one axis, with bands for samples, or a map over two axes.

        Parameters
        ----------
        outcome : str, optional
            A column of the survey; by default the first one.
        **options
            `axes`, `figsize` and `style`, as for all plots.

        Returns
        -------
        Figure
        """
        from ..plots.survey import plot_survey

        return plot_survey(self, outcome, **options)

    def best(
        self, outcome: str, largest: bool = False, quantile: float | None = None, covered: float = LEAST_SHARE
    ) -> tuple[dict[str, float], float]:
        """Return the point of the axes with the lowest (or largest) outcome.

        At each point the worst sample counts, or a quantile of the samples. A point at which a system failed, or its outcome is not
        known (see `known`), is never the best.

        Parameters
        ----------
        outcome : str
            A column of the survey.
        largest : bool
            Return the largest value instead of the lowest.
        quantile : float, optional
            Quantile of the samples, 0 to 1; by default the worst one counts.
        covered : float
            Smallest share of the interval that the known responses must cover.

        Returns
        -------
        point : dict
            Values of the parameters on the axes.
        value : float
            The outcome there.

        Raises
        ------
        PlanError
            If the outcome is known at no point.
        """
        value = self.judged(outcome, largest, quantile, covered)
        if not np.isfinite(value).any():
            raise PlanError(f"{outcome} is known of no system of the survey; the notes say why")
        flat = int(np.nanargmax(value) if largest else np.nanargmin(value))
        place = np.unravel_index(flat, value.shape)
        point = {name: float(values[i]) for (name, values), i in zip(self.plan.axes.items(), place)}
        return point, float(value[place])

    def judged(self, outcome: str, largest: bool, quantile: float | None, covered: float) -> np.ndarray:
        """Return an outcome over the axes alone, reduced over the samples to the worst one or a quantile; arguments as for `best`."""
        value = self.known(outcome, covered) * (sign := -1.0 if largest else 1.0)
        if self.plan.samples:
            with np.errstate(invalid="ignore"):
                value = np.max(value, axis=-1) if quantile is None else np.quantile(value, quantile, axis=-1)
        return sign * value

    def __repr__(self) -> str:
        counts = {"failed": self.failed, "not done yet": self.waiting}
        more = "".join(f", {count} {state}" for state, count in counts.items() if count)
        return f"Survey({len(self.plan)} systems over {', '.join(self.plan.names)}: {', '.join(self.columns) or 'no outcomes'}{more})"

    def __str__(self) -> str:
        return titled(self._title(), self._table())

    def _repr_html_(self) -> str:
        return f"<p>{html.escape(self._title())}</p>{self._table().html()}"

    def _title(self) -> str:
        text = f"{len(self.plan)} systems over {', '.join(self.plan.names)}"
        if self.failed:
            text += f"; {self.failed} of them failed, the column note says why"
        if self.waiting:
            text += f"; {self.waiting} not done yet"
        if self.partly:
            text += f"; {self.partly} known in part, the column note says why"
        return text

    def _table(self) -> Table:
        rows: list[tuple[str, ...]] = []
        for name, values in self.columns.items():
            finite = values[np.isfinite(values)]
            numbers = [figures(f(finite)) if finite.size else "-" for f in (np.min, np.median, np.max)]
            rows.append((name, *numbers, self.units.get(name, "")))
        return Table(("outcome", "smallest", "median", "largest", "unit"), rows)


def load_survey(path: str | Path) -> Survey:
    """Read a survey from its NetCDF file.

    Raises
    ------
    PlanError
        If there is no such file, it is not the file of a survey, or it is damaged.
    """
    data = read(Path(path))
    damaged = PlanError(f"{path}: this is not the NetCDF file of a survey, or it is damaged")
    try:
        metadata = json.loads(data.attrs["about"])
        # in the order of the dimensions; the JSON text about the survey has them in alphabetic order
        axes = {str(name): data[name].values for name in data["note"].dims if name in metadata["axes"]}
        samples = {str(name): data[name].values for name in data.coords if name in metadata["samples"]}
        columns = {str(n): v.values for n, v in data.data_vars.items() if n != "note"}
        units, notation = (
            {str(n): str(v.attrs[key]) for n, v in data.variables.items() if key in v.attrs and n != "note"}
            for key in ("units", "long_name")
        )
        notes = data["note"].values.astype(object)
        plan = Plan(axes, samples)
        complete = all(values.shape == plan.shape for values in (notes, *columns.values()))
    except (LookupError, ValueError, TypeError, AttributeError):
        raise damaged from None
    if not complete:
        raise damaged
    return Survey(plan, columns, notes, units, metadata, notation)


FORMAT = "contvines survey 2"  # format 1 had no digest
BLANK = b"0" * 64
MARK = b"sha256\0\0" + (2).to_bytes(4, "big") + len(BLANK).to_bytes(4, "big")
"""Bytes before the digest in the file: name, type (text) and length of the attribute (NetCDF classic format, section on attributes)."""


def write(data: Dataset, path: Path) -> None:
    """Write a data set with its digest as a NetCDF file; an existing file is replaced atomically.

    Parameters
    ----------
    data : xarray.Dataset
    path : Path
    """
    draft = path.with_name(path.name + ".new")
    marked = data.assign_attrs(format=FORMAT, sha256=BLANK.decode())
    # the engine of scipy needs no netCDF library
    marked.to_netcdf(draft, engine="scipy", format="NETCDF3_64BIT")
    content = draft.read_bytes()
    place = content.index(MARK) + len(MARK)
    digest = hashlib.sha256(content).hexdigest().encode()
    draft.write_bytes(content[:place] + digest + content[place + len(BLANK) :])
    os.replace(draft, path)


def read(path: Path) -> Dataset:
    """Read the data set of a survey's file into memory.

    Raises
    ------
    PlanError
        If there is no such file, it is not the file of a survey, or it is damaged.
    """
    xarray = needed("xarray", "tables")

    try:
        content = path.read_bytes()
    except FileNotFoundError:
        raise PlanError(f"{path}: there is no such file") from None
    except OSError as error:
        raise PlanError(f"{path}: this file cannot be read ({error.strerror})") from None
    if not _digest_matches(content):
        raise PlanError(
            f"{path}: this file is damaged, it has changed since it was written; move it away, and the survey makes it again"
        )
    try:
        with xarray.open_dataset(io.BytesIO(content), engine="scipy") as data:
            data.load()
    except (
        Exception
    ):  # a file of another kind, or a damaged one without digest: the reader may raise any error
        raise PlanError(f"{path}: this is not the NetCDF file of a survey, or it is damaged") from None
    return data


def _digest_matches(content: bytes) -> bool:
    """Whether the digest in a file matches its content; true for files of format 1, which have none."""
    before, mark, after = content.partition(MARK)
    if not mark:
        return FORMAT.encode() not in content
    digest, rest = after[: len(BLANK)], after[len(BLANK) :]
    return hashlib.sha256(before + mark + BLANK + rest).hexdigest().encode() == digest
