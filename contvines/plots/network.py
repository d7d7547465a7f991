"""The graph itself: branches as boxes, switches as arrows."""

from typing import TYPE_CHECKING, Any

from .style import new_axes, styled

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from ..graph.graph import Graph


def plot_network(graph: "Graph", *, axes: "Axes | None" = None) -> "Figure":
    """Draw branches (boxes: label, word, range) from left to right by the number of switches that lead to them.

    A solid box is a real branch, a dotted one a virtual branch; a grey filling says that some of it is stable.
    """
    from matplotlib.patches import FancyArrowPatch

    rows = _layers(graph)
    wide, high = max(len(rows), 1), max((len(r) for r in rows), default=1)
    with styled():
        figure, axes = new_axes(axes, figsize=(max(4.5, 2.9 * wide), max(2.4, 1.15 * high + 0.6)))
        axes.set_axis_off()
        place = {
            label: (float(column), -(i - (len(labels) - 1) / 2))
            for column, labels in enumerate(rows)
            for i, label in enumerate(labels)
        }
        boxes: dict[str, Any] = {}
        for label, (px, py) in place.items():
            branch = graph.branches[label]
            some = bool(branch.stable.any()) and branch.real
            style = {
                "fc": "0.90" if some else "white",
                "ec": "black",
                "ls": "-" if branch.real else ":",
                "lw": 1.0,
            }
            boxes[label] = axes.text(
                px,
                py,
                _caption(branch),
                ha="center",
                va="center",
                fontsize=8,
                bbox={"boxstyle": "round,pad=0.45", **style},
            )
        pairs: dict[tuple[str, str], list[Any]] = {}
        for switch in graph.switches:
            if switch.source in place and switch.target in place:
                pairs.setdefault((switch.source, switch.target), []).append(switch)
        axes.set_xlim(-0.5, wide - 0.5)
        axes.set_ylim(-(high - 1) / 2 - 0.6, (high - 1) / 2 + 0.6)
        figure.draw_without_rendering()
        for (source, target), switches in pairs.items():
            same = place[source][0] == place[target][0]
            (ax, ay), (bx, by) = place[source], place[target]
            axes.add_patch(
                FancyArrowPatch(
                    (ax, ay),
                    (bx, by),
                    patchA=boxes[source].get_bbox_patch(),
                    patchB=boxes[target].get_bbox_patch(),
                    connectionstyle="arc3,rad=0.25" if same or (target, source) in pairs else "arc3,rad=0",
                    arrowstyle="-|>",
                    mutation_scale=10,
                    color="0.35",
                    linewidth=0.9,
                    zorder=1,
                )
            )
            text = ", ".join(dict.fromkeys(s.point for s in switches))
            shift = 0.14 * (bx - ax) if (target, source) in pairs else 0.0
            axes.text(
                (ax + bx) / 2 + (0.13 if same else 0),
                (ay + by) / 2 + shift,
                text,
                ha="center",
                va="center",
                fontsize=8,
                bbox={"boxstyle": "square,pad=0.12", "fc": "white", "ec": "none"},
                zorder=4,
            )
        if graph.branches:
            axes.set_title(
                "grey: partly stable; dotted: virtual; arrows: switches at special points", fontsize=8.5
            )
    return figure


def _layers(graph: "Graph") -> list[list[str]]:
    """Labels by the number of switches that lead to them, each layer in the graph's order."""
    depth: dict[str, int] = {}
    for label in graph.branches:
        if label in depth:
            continue
        front = [label]
        depth[label] = 0
        while front:
            found = []
            for switch in graph.switches:
                if switch.source in front and switch.target in graph.branches and switch.target not in depth:
                    depth[switch.target] = depth[switch.source] + 1
                    found.append(switch.target)
            front = found
    layers: list[list[str]] = [[] for _ in range(max(depth.values(), default=-1) + 1)]
    for label in graph.branches:
        layers[depth[label]].append(label)
    return layers


def _caption(branch: Any) -> str:
    word = branch.description.get("word")
    if word and len(word) > 18:
        word = word[:15] + "..."
    periods = branch.description.get("periods")
    what = f"  {word}" if word else ""
    cycles = f"  k={periods}" if periods else ""
    low, high = branch.range
    return f"{branch.label}{what}{cycles}\n{branch.parameter} {low:.4g} to {high:.4g}"
