"""Graph: branches, special points and the switches that connect them."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, TypedDict, Unpack

from contvines.shared.near_names import did_you_mean

from ..bifurcation.kind import Kind
from ..bifurcation.kinds import LABELS, RENAMED, kind_named
from ..continuation.settings import hinted
from ..journal import Resumable
from ..problems.abilities import Several, notation_of
from ..shared.figures import PlotOptions
from .contents import Attractor, Unresolved

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from matplotlib.figure import Figure

    from ..branches import Branch
    from ..branches.special_point import SpecialPoint
    from ..problems.protocol import Problem


@dataclass(frozen=True)
class Switch:
    """A connection of two branches at a special point.

    Attributes
    ----------
    point : str
        Label of the special point at which they meet.
    source, target : str
        Labels of branches.
    kind : str
        Kind of the special point.
    note : str
        At a border "persistence" or "nonsmooth fold"; remarks such as "mirror image not traced".
    """

    point: str
    source: str
    target: str
    kind: str
    note: str = ""

    def to_dict(self) -> dict[str, Any]:
        """The entry of this switch in the JSON of a graph."""
        return {
            "point": self.point,
            "from": self.source,
            "to": self.target,
            "kind": self.kind,
            "note": self.note,
        }


class CurveOptions(TypedDict, total=False):
    """Options of :func:`contvines.plots.diagram.plot_diagram` for branches and special points."""

    labels: bool | Sequence[str]
    ends: bool
    marks: bool | Sequence[str]
    words: bool
    color: str
    name: str | None
    inset: bool | tuple[tuple[float, float], tuple[float, float]]


class DiagramOptions(CurveOptions, PlotOptions, total=False):
    """All options of :func:`contvines.plots.diagram.plot_diagram`."""

    xlim: tuple[float, float] | None
    ylim: tuple[float, float] | None


@hinted
@dataclass(eq=False)
class Graph(Resumable):
    """Branches and special points by label, and the switches between branches.

    Attributes
    ----------
    parameter : str
        Name of the continuation parameter.
    model : dict
        Name and fixed parameters of the model (JSON-able).
    branches : dict of Branch
        By label.
    special : dict of SpecialPoint
        By label.
    switches : list of Switch
        Connections of branches at special points.
    within : (float, float)
        Interval of the parameter.
    settings : dict
        Settings of the run, ``depth`` and ``virtual`` included (JSON-able).
    finished : bool
        False while the graph is computed, or after the computation was interrupted.
    message : str
        State of the computation, as a sentence.
    start : str
        If the given start was no solution: a sentence that says where the branch begins instead. Else empty.
    complete : bool
        False if branches were left waiting at ``max_branches`` or ``max_unknowns``, or the budget of an atlas was used up.
    looked : bool
        Whether simulated starts were compared with the finished graph; the motions that it lacks are in `missing`.
    proofs : dict of dict
        By label: the proved claims (existence, real, stable, radius) and the certificate; see `prove`.
    attractors : list of Attractor
        For an atlas: motions on which simulated starts settled, with their shares and branches.
    missing : list of Attractor
        Motions found by simulation that lie on no branch; see `looked`.
    unresolved : list of Unresolved
        Stretches of branches on which special points cannot be distinguished, with the counts of multipliers on both sides.
    """

    parameter: str = "p"
    model: dict[str, Any] = field(default_factory=dict)
    branches: dict[str, Branch] = field(default_factory=dict)
    special: dict[str, SpecialPoint] = field(default_factory=dict)
    switches: list[Switch] = field(default_factory=list)
    within: tuple[float, float] = (float("-inf"), float("inf"))
    settings: dict[str, Any] = field(default_factory=dict)
    finished: bool = False
    message: str = ""
    start: str = ""
    complete: bool = True
    looked: bool = False
    proofs: dict[str, dict[str, Any]] = field(default_factory=dict)
    attractors: list[Attractor] = field(default_factory=list)
    missing: list[Attractor] = field(default_factory=list)
    unresolved: list[Unresolved] = field(default_factory=list)

    def __getitem__(self, label: str):
        if label in self.special:
            return self.special[label]
        if label in self.branches:
            return self.branches[label]
        labels = ", ".join([*self.branches, *self.special]) or "none yet"
        raise KeyError(f"the graph has no label {label!r}; it has {labels}")

    def __contains__(self, label: object) -> bool:
        return label in self.special or label in self.branches

    def __iter__(self):
        yield from self.branches.values()

    def __len__(self) -> int:
        return len(self.branches)

    def __str__(self) -> str:
        from .table import shown

        text = shown(self)
        return f"{text}\n\n{self.message}" if self._cut else text

    @property
    def stopped(self) -> bool:
        """Whether this is an atlas that has used up its budget."""
        return bool(self.settings.get("left"))

    @property
    def _cut(self) -> bool:
        """Whether branches were left waiting at a limit, and more than one branch was wanted."""
        return not self.complete and self.settings.get("max_branches") != 1

    def _repr_html_(self) -> str:
        from .table import graph_page

        return graph_page(self) + (f"<p>{self.message}</p>" if self._cut else "")

    def __repr__(self) -> str:
        state = "" if self.finished else ", unfinished"
        return f"Graph({len(self.branches)} branches, {len(self.special)} special points, {len(self.switches)} switches{state})"

    @property
    def units(self) -> dict[str, str]:
        """Units of the parameter and the measures, by name; empty if there are none."""
        return next((dict(b.description.get("units") or {}) for b in self.branches.values()), {})

    @property
    def notation(self) -> dict[str, str]:
        """Axis labels of parameters and measures, by name; empty for user-defined equations."""
        return notation_of(*(branch.problem for branch in self.branches.values()))

    def on(self, branch: str) -> list[SpecialPoint]:
        """Return the special points of a branch, in order along it.

        Raises
        ------
        KeyError
            If there is no such branch.
        """
        if branch not in self.branches:
            raise KeyError(f"the graph has no branch {branch!r}; it has {', '.join(self.branches) or 'none'}")
        return [self.special[label] for _, label in self.branches[branch].marks if label in self.special]

    def of_kind(self, kind: str) -> list[SpecialPoint]:
        """Return the special points of a kind, in the order in which they were found.

        Raises
        ------
        ValueError
            If there is no such kind.
        """
        labels = {**LABELS, **{name: entry.label for name, entry in self.own_kinds.items()}}
        kind = RENAMED.get(kind, kind)
        if kind not in labels:
            named = next((name for name, prefix in labels.items() if prefix == kind), None)
            hint = f" (did you mean {named!r}?)" if named else did_you_mean(kind, labels)
            raise ValueError(f"there is no kind {kind!r}{hint}; choose from {', '.join(labels)}")
        return [point for point in self.special.values() if point.kind == kind]

    @property
    def own_kinds(self) -> dict[str, Kind]:
        """User-defined kinds by name; for a graph from a file only with label, text and marker."""
        return {fields["name"]: Kind(**fields) for fields in self.settings.get("kinds", [])}

    def kind(self, name: str) -> Kind:
        """Return the kind of this name, built-in or user-defined: its label, text and marker."""
        return kind_named(name, self.own_kinds)

    def prove(self, *labels: str, **options: Any) -> dict[str, Any]:
        """Prove special points, orbits (``B1:12``) or branches; see :func:`contvines.graph.proving.prove`."""
        from .proving import prove

        return prove(self, labels, **options)

    def attach(self, problem: Problem | Several) -> None:
        """Set the problem of all branches and special points that have none, after loading a graph of Python callables.

        Parameters
        ----------
        problem : Problem or Several
            The problem, or an object with a problem for each branch, as a FlowProblem.
        """
        own = {
            label: problem.problem_of(branch.description) if isinstance(problem, Several) else problem
            for label, branch in self.branches.items()
        }
        for label, branch in self.branches.items():
            if branch.problem is None and branch.points.shape[1] == own[label].dimension:
                branch.problem = own[label]
        for point in self.special.values():
            if point.problem is None and len(point.u) == own[point.branch].dimension:
                point.problem = own[point.branch]

    def to_dict(self) -> dict[str, Any]:
        """Return the graph as a JSON-able dict: model, parameter, branches, special, switches, ..."""
        return {
            "model": self.model,
            "parameter": self.parameter,
            "within": list(self.within),
            **({"units": self.units} if self.units else {}),
            "finished": self.finished,
            "message": self.message,
            **({"start": self.start} if self.start else {}),
            "branches": [branch.to_dict() for branch in self.branches.values()],
            "special": [point.to_dict() for point in self.special.values()],
            "switches": [switch.to_dict() for switch in self.switches],
            **({"unresolved": [u.to_dict() for u in self.unresolved]} if self.unresolved else {}),
            **({"proofs": self._claims()} if self.proofs else {}),
            **({"attractors": [a.to_dict() for a in self.attractors]} if self.attractors else {}),
            **({"missing": [a.to_dict() for a in self.missing]} if self.missing else {}),
        }

    def _claims(self) -> dict[str, Any]:
        """Return the proved claims, without the certificates."""
        return {
            label: {name: value for name, value in proof.items() if name != "certificate"}
            for label, proof in self.proofs.items()
        }

    def nodes(self) -> Iterator[tuple[str, dict[str, Any]]]:
        """Return the branches as nodes of a network: label and attributes."""
        return ((branch.label, branch.to_dict()) for branch in self.branches.values())

    def edges(self) -> Iterator[tuple[str, str, dict[str, Any]]]:
        """Generate the switches as edges of a network: labels of both branches, and attributes."""
        for switch in self.switches:
            point = self.special[switch.point]
            yield (
                switch.source,
                switch.target,
                {
                    "point": switch.point,
                    "kind": switch.kind,
                    "value": float(point.value),
                    "criticality": point.criticality,
                    "note": switch.note,
                },
            )

    def network(self):
        """Return the graph as a networkx MultiDiGraph: nodes are branches, edges are switches.

        Raises
        ------
        ValueError
            If networkx is not installed.
        """
        from ..shared.on_demand import needed

        networkx = needed("networkx", "tables")
        network = networkx.MultiDiGraph(parameter=self.parameter, finished=self.finished)
        network.add_nodes_from(self.nodes())
        for a, b, data in self.edges():
            network.add_edge(a, b, data["point"], **data)
        return network

    def merge(self, other: Graph) -> dict[str, str]:
        """Add the branches and special points of another graph of the same problem; see :func:`contvines.coexistence.merging.merge`."""
        from ..coexistence.merging import merge

        return merge(self, other)

    def to_pandas(self):
        """Return all points of all branches as a data frame; see :func:`contvines.export.frames.graph_frame`."""
        from ..export.frames import graph_frame

        return graph_frame(self)

    def points_to_pandas(self):
        """Return the special points as a data frame; see :func:`contvines.export.frames.points_frame`."""
        from ..export.frames import points_frame

        return points_frame(self)

    def to_xarray(self):
        """Return all points of all branches as a data set; see :func:`contvines.export.frames.graph_dataset`."""
        from ..export.frames import graph_dataset

        return graph_dataset(self)

    def export(self, path: str | Path, to: str | None = None) -> Path:
        """Write the graph for other programs.

        Parameters
        ----------
        path : str or Path
            For ``"auto"`` the common NAME of the files b.NAME, s.NAME and d.NAME.
        to : {"csv", "json", "graphml", "mat", "latex", "auto", "xpp"}, optional
            Format; by default from the ending of `path`.

        Returns
        -------
        Path
            The written file.

        Raises
        ------
        ValueError
            If there is no such format, or the file cannot be written.
        """
        from ..export import export

        return export(self, to, path)

    def plot(self, x: str | None = None, y: str | None = None, **options: Unpack[DiagramOptions]) -> Figure:
        """Draw the bifurcation diagram as a matplotlib figure; see :func:`contvines.plots.diagram.plot_diagram`."""
        from ..plots.diagram import plot_diagram

        return plot_diagram(self, x=x, y=y, **options)

    def entries(self) -> Iterator[tuple[str, str, dict[str, Any]]]:
        """Generate the graph's entries of a file as (kind, key, content)."""
        from .persistence import graph_entries

        return graph_entries(self)

    def save(self, path: str | Path) -> None:
        """Write the graph to a .vines file, which :func:`contvines.load` reads.

        Raises
        ------
        ValueError
            If the file cannot be written, or exists and is no .vines file.
        """
        from pathlib import Path

        place = Path(path)
        if place.is_dir():
            raise ValueError(f"{place}: this is a folder; give the name of a file in it.")
        if not place.parent.is_dir():
            raise ValueError(
                f"{place}: there is no folder {str(place.parent)!r}; make it first, or choose another place."
            )
        from ..store import save

        save(self, path)

    @classmethod
    def load(cls, path: str | Path, *, trust: bool = False) -> Graph:
        """Read a graph from a .vines file; see :func:`contvines.load`.

        Raises
        ------
        ValueError
            If the file holds a chart.
        """
        from ..store import load

        found = load(path, trust=trust)
        if not isinstance(found, Graph):
            raise ValueError(f"{path}: this file holds a chart; contvines.load reads it")
        return found
