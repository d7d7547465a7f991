"""The legend of a picture: one per axes, in a place where it covers nothing."""

from __future__ import annotations

from collections.abc import Sequence

from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.layout_engine import ConstrainedLayoutEngine
from matplotlib.legend import Legend

from contvines.shared.figures import legend_below, narrower, root, settle
from contvines.shared.near_names import did_you_mean

from .labels import Raster

NARROW = 5.0  # inches: in narrower figures the legend is below the axes
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
    """Draw or renew the legend of axes, at the place that the user asks for, or where it covers nothing and leaves room for the axes.

    Parameters
    ----------
    axes : Axes
    handles : list of Artist
        Entries with labels, in addition to those of the present legend and of the axes; each label appears once.
    where : bool or str
        False: none. True: the usual place, but below in a narrow figure. "inside", "beside", "below", or a location of matplotlib.
    own : bool
        Whether the figure was made by `new_figure`; in other figures True means inside.
    usual : {"inside", "beside", "below"}
        Meaning of True in a wide new figure; a legend that would cover something inside is drawn beside the axes.
    remarks : sequence of str
        Labels among `handles` without a line or mark; below the axes they are added to the label of the x axis.

    Raises
    ------
    ValueError
        If `where` is unknown.
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
    covers = where is True and own and Raster(axes, legend=False).covered(box)[0] > 0.0
    if place == "beside" or covers:
        legend.set_loc("upper left")
        legend.set_bbox_to_anchor((1.01, 1.0), transform=axes.transAxes)
        engine = figure.get_layout_engine()
        if own and isinstance(engine, ConstrainedLayoutEngine):
            engine.set(w_pad=0.09)  # inches: texts are a little wider at the resolution of a file
        figure.draw_without_rendering()
        figure.draw_without_rendering()  # twice: narrower axes have fewer ticks, which changes the layout again


def hold_legend(axes: Axes) -> None:
    """Fix the legend at its present position."""
    legend = axes.get_legend()
    if legend is not None:
        place = axes.transAxes.inverted().transform(legend.get_window_extent().min)
        legend.set_bbox_to_anchor(None)
        legend.set_loc(tuple(place.tolist()))
