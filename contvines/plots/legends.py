"""The legend of a picture: what its lines and marks mean, once per axes, in a place that hides nothing."""

from __future__ import annotations

from collections.abc import Sequence

from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.layout_engine import ConstrainedLayoutEngine
from matplotlib.legend import Legend

from contvines.shared.figures import legend_below, narrower, root, settle
from contvines.shared.near_names import did_you_mean

from .labels import Ground

NARROW = 5.0  # inches: in a narrower figure the legend stands below the axes
PLACES = ("inside", "beside", "below")


def place_legend(
    axes: Axes,
    handles: Sequence[Artist],
    where: bool | str,
    own: bool,
    *,
    usual: str = "inside",
    remarks: Sequence[str] = (),
) -> None:
    """Write or renew the legend of axes where the user wants it, or where it squeezes and hides nothing.

    Parameters
    ----------
    axes : Axes
    handles : list of Artist
        With labels, besides those that stand in the legend already and those on the axes; each label comes once.
    where : bool or str
        False: none. True: the usual place, but below in a narrow figure. "inside", "beside", "below", or a place of matplotlib's.
    own : bool
        Whether the figure is ours to be laid out; else True means inside.
    usual : {"inside", "beside", "below"}
        What True means in a wide figure of ours; inside gives way to beside where it would cover something.
    remarks : sequence of str
        Labels among `handles` that are words alone; below they go to the label of the axis.

    Raises
    ------
    ValueError
        If `where` is no place.
    """
    before = axes.get_legend()
    pairs = [] if before is None else zip(before.get_texts(), before.legend_handles, strict=False)
    entries = {text.get_text(): handle for text, handle in pairs if handle is not None}
    for handle in (*handles, *axes.get_legend_handles_labels()[0]):
        entries.setdefault(str(handle.get_label()), handle)
    if where is False or not entries:
        return
    known = [*PLACES, *Legend.codes]
    if isinstance(where, str) and where not in known:
        raise ValueError(
            f"legend = {where!r} is unknown{did_you_mean(where, known)}; choose of {', '.join(known)}"
        )
    place = "inside" if not own else "below" if narrower(axes, NARROW) else usual
    place = where if isinstance(where, str) else place
    if place == "below":
        axes.set_xlabel("\n".join([axes.get_xlabel(), *remarks]))
        legend_below(axes, [handle for label, handle in entries.items() if label not in remarks], own)
        return
    code = Legend.codes.get(place, Legend.codes["best"])
    legend = axes.legend(handles=[*entries.values()], handlelength=2.4, loc=code)
    if place not in PLACES:
        return
    figure = root(axes)
    settle(figure)
    box = legend.get_window_extent().extents
    covers = where is True and own and Ground(axes, legend=False).covered(box)[0] > 0.0
    if place == "beside" or covers:
        legend.set_loc("upper left")
        legend.set_bbox_to_anchor((1.01, 1.0), transform=axes.transAxes)
        engine = figure.get_layout_engine()
        if own and isinstance(engine, ConstrainedLayoutEngine):
            engine.set(w_pad=0.09)  # inches: texts are a little wider at the resolution of a file
        figure.draw_without_rendering()
        figure.draw_without_rendering()  # the axes become narrower, and then their ticks fewer


def hold_legend(axes: Axes) -> None:
    """Keep the legend where it is now, whatever is written later."""
    legend = axes.get_legend()
    if legend is not None:
        place = axes.transAxes.inverted().transform(legend.get_window_extent().min)
        legend.set_bbox_to_anchor(None)
        legend.set_loc(tuple(place.tolist()))
