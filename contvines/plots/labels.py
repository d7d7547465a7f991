"""Labels that keep clear of curves, of marks and of one another."""

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_DIRECTIONS = [(1, 1), (-1, 1), (1, -1), (-1, -1), (0, 1), (1, 0), (-1, 0), (0, -1)]


def place_labels(
    axes: "Axes",
    anchors: list[tuple[float, float]],
    texts: list[str],
    obstacles: np.ndarray,
    *,
    size: float = 8.5,
    colors: list[str] | None = None,
    optional: int = 0,
    taken: list[tuple[float, float, float, float]] | None = None,
) -> None:
    """Write each text near its anchor where it covers least.

    Parameters
    ----------
    axes : drawn on; its limits must be final.
    anchors, texts : data coordinates and labels, in order of precedence.
    obstacles : data coordinates to keep clear of, shape (n, 2).
    size : font size in points.
    colors : one per text.
    optional : how many of the last texts are left out rather than put far from their anchors.
    taken : boxes on the page (x0, y0, x1, y1) that no text may touch, such as the legend's.
    """
    transform = axes.transData.transform
    figure = axes.get_figure(root=True)
    assert figure is not None
    unit = figure.dpi / 72.0
    anchors_ = transform(np.asarray(anchors, float).reshape(-1, 2))
    blocked = transform(np.asarray(obstacles, float).reshape(-1, 2))
    blocked = blocked[np.isfinite(blocked).all(axis=1)]
    frame = axes.bbox
    boxes: list[tuple[float, float, float, float]] = []
    for i, (anchor, text) in enumerate(zip(anchors_, texts)):
        if not np.isfinite(anchor).all():
            continue
        width, height = (0.62 * size * len(text) + 2) * unit, 1.25 * size * unit
        best = None
        for radius in (7, 13, 22, 34, 50, 75, 110):
            for dx, dy in _DIRECTIONS:
                norm = np.hypot(dx, dy)
                cx = anchor[0] + dx / norm * radius * unit + 0.5 * dx * width
                cy = anchor[1] + dy / norm * radius * unit + 0.5 * dy * height
                box = (cx - width / 2, cy - height / 2, cx + width / 2, cy + height / 2)
                out = max(frame.x0 - box[0], box[2] - frame.x1, frame.y0 - box[1], box[3] - frame.y1, 0)
                pad = 1.5 * unit
                inside = (
                    (blocked[:, 0] > box[0] - pad)
                    & (blocked[:, 0] < box[2] + pad)
                    & (blocked[:, 1] > box[1] - pad)
                    & (blocked[:, 1] < box[3] + pad)
                )
                met = sum(_overlap(box, other) for other in boxes)
                others = np.delete(anchors_, i, axis=0)
                on_marks = _inside(others, box, 4 * unit)
                met += 4 * sum(_overlap(box, other) for other in taken or ())
                cost = min(inside.sum(), 40) + 60 * met + 25 * on_marks + 10 * out / unit + 0.25 * radius
                if best is None or cost < best[0]:
                    best = (cost, cx, cy, box, radius)
        assert best is not None
        cost, cx, cy, box, radius = best
        far = radius > 15
        if i >= len(texts) - optional and (far or cost > 30):
            continue
        boxes.append(box)
        color = colors[i] if colors else "black"
        axes.annotate(
            text,
            xy=tuple(axes.transData.inverted().transform(anchor)),
            xytext=((cx - anchor[0]) / unit, (cy - anchor[1]) / unit),
            textcoords="offset points",
            ha="center",
            va="center",
            fontsize=size,
            color=color,
            arrowprops={"arrowstyle": "-", "color": "0.55", "lw": 0.6, "shrinkA": 1, "shrinkB": 3}
            if far
            else None,
            bbox={"boxstyle": "square,pad=0.05", "fc": "white", "ec": "none", "alpha": 0.75},
            zorder=8,
        )


def merge_labels(
    axes: "Axes", anchors: list[tuple[float, float]], texts: list[str], near: float = 9.0
) -> tuple[list[tuple[float, float]], list[str]]:
    """One label for marks that lie within `near` points of one another on the page; "+n" stands for n more."""
    figure = axes.get_figure(root=True)
    assert figure is not None
    screen = axes.transData.transform(np.asarray(anchors, float).reshape(-1, 2)) * 72.0 / figure.dpi
    merged: list[list[int]] = []
    for i, point in enumerate(screen):
        for group in merged:
            if np.hypot(*(screen[group[0]] - point)) < near:
                group.append(i)
                break
        else:
            merged.append([i])
    names = [list(dict.fromkeys(texts[i] for i in group)) for group in merged]
    short = [", ".join(n) if len(n) <= 4 else f"{', '.join(n[:3])} +{len(n) - 3}" for n in names]
    return [anchors[group[0]] for group in merged], short


def _overlap(a: tuple[float, ...], b: tuple[float, ...]) -> bool:
    return a[0] < b[2] and b[0] < a[2] and a[1] < b[3] and b[1] < a[3]


def _inside(points: np.ndarray, box: tuple[float, ...], pad: float) -> int:
    x, y = points[:, 0], points[:, 1]
    return int(((x > box[0] - pad) & (x < box[2] + pad) & (y > box[1] - pad) & (y < box[3] + pad)).sum())
