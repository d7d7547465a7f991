"""Animations to files: gif by pillow, mp4 by ffmpeg, html with its own player."""

from __future__ import annotations

import math
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from matplotlib.animation import FuncAnimation
    from matplotlib.artist import Artist
    from matplotlib.figure import Figure

ENDINGS = ("gif", "mp4", "html")
DPI = 100


def check_animation(path: str | Path) -> Path:
    """Refuse, before any work, a file that no animation could be written to.

    Raises
    ------
    ValueError
        If the ending is not known, there is no such folder, or an mp4 is asked for without ffmpeg.
    """
    place = Path(path)
    ending = place.suffix.lstrip(".").lower()
    if ending not in ENDINGS:
        raise ValueError(
            f"{place}: an animation ends in .{', .'.join(ENDINGS)}; use {place.with_suffix('.gif')}."
        )
    if place.is_dir() or not place.parent.is_dir():
        what = "this is a folder" if place.is_dir() else f"there is no folder {str(place.parent)!r}"
        raise ValueError(f"{place}: {what}; choose another place.")
    if ending == "mp4":
        from matplotlib.animation import FFMpegWriter

        if not FFMpegWriter.isAvailable():
            raise ValueError(
                f"{place}: an mp4 needs the program ffmpeg, which is not on the PATH; {place.with_suffix('.gif')} or "
                f"{place.with_suffix('.html')} needs nothing."
            )
    return place


def animated(
    figure: Figure, move: Callable[[int], object], path: str | Path | None, seconds: float, rate: int
) -> FuncAnimation:
    """Move what is drawn, picture by picture, and write the file if a path is given.

    Parameters
    ----------
    figure : Figure
        With all that is drawn; what is laid out stays where it is.
    move : callable
        Of the number of the picture.
    path : path, optional
    seconds, rate : float, int
        How long it takes, and pictures a second; see `pictures`.
    """
    from matplotlib import rc_context

    figure.draw_without_rendering()

    def draw(frame: int) -> list[Artist]:
        move(frame)
        return []

    # all has its place: with a layout engine every picture is drawn once more
    with rc_context({"figure.constrained_layout.use": False, "figure.autolayout": False}):
        figure.set_layout_engine(None)
        made = _animation_class()(
            figure, draw, frames=pictures(seconds, rate), interval=1000.0 / rate, blit=False
        )
        if path is not None:
            save_animation(made, path, rate)
    return made


def _animation_class() -> type[FuncAnimation]:
    from matplotlib import rc_context
    from matplotlib.animation import FuncAnimation

    class Animation(FuncAnimation):
        """An animation that shows itself in a notebook, with its player."""

        def __repr__(self) -> str:
            return "Animation: a notebook shows it with its player, .save(FILE) writes it"

        def _repr_html_(self) -> str:
            with rc_context({"savefig.dpi": DPI}):
                return self.to_jshtml()

    return Animation


def pictures(seconds: float, rate: int) -> int:
    """How many pictures an animation has.

    Raises
    ------
    ValueError
        If one of the numbers is not positive.
    """
    if not (math.isfinite(seconds) and seconds > 0.0 and rate >= 1):
        raise ValueError(f"seconds = {seconds!r} and rate = {rate!r} must be positive")
    return max(2, round(seconds * rate))


def save_animation(animation: FuncAnimation, path: str | Path, rate: int) -> Path:
    """Write an animation; the ending says how.

    Parameters
    ----------
    animation : FuncAnimation
    path : path
    rate : int
        Pictures a second.

    Raises
    ------
    ValueError
        As `check_animation` does, or if the file cannot be written.
    """
    from matplotlib import rc_context

    place = check_animation(path)
    try:
        if place.suffix.lower() == ".html":
            with rc_context({"savefig.dpi": DPI}):
                place.write_text(animation.to_jshtml(fps=rate), encoding="utf-8")
        else:
            writer = "pillow" if place.suffix.lower() == ".gif" else "ffmpeg"
            animation.save(str(place), writer=writer, fps=rate, dpi=DPI)
    except OSError as error:
        raise ValueError(f"{place}: cannot be written ({error.strerror}).") from None
    return place
