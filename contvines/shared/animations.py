"""Write animations to files: gif by pillow, mp4 by ffmpeg, html with a player."""

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
    """Check, before any work, that an animation can be written to a file; return its path.

    Raises
    ------
    ValueError
        If the ending is unknown, the folder does not exist, or ffmpeg is missing for an mp4.
    """
    place = Path(path)
    ending = place.suffix.lstrip(".").lower()
    if ending not in ENDINGS:
        raise ValueError(
            f"{place}: an animation ends in .{', .'.join(ENDINGS)}; use {place.with_suffix('.gif')}."
        )
    if place.is_dir() or not place.parent.is_dir():
        fault = "this is a folder" if place.is_dir() else f"there is no folder {str(place.parent)!r}"
        raise ValueError(f"{place}: {fault}; choose another place.")
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
    """Animate a figure frame by frame, and write the animation to a file if a path is given.

    Parameters
    ----------
    figure : Figure
        With everything drawn; its layout is not changed.
    move : callable
        ``move(frame)`` updates the figure for a frame number.
    path : path, optional
    seconds, rate : float, int
        Duration, and frames per second.
    """
    from matplotlib import rc_context

    figure.draw_without_rendering()

    def draw(frame: int) -> list[Artist]:
        move(frame)
        return []

    # the layout is final: a layout engine would draw every frame twice
    with rc_context({"figure.constrained_layout.use": False, "figure.autolayout": False}):
        figure.set_layout_engine(None)
        animation = _animation_class()(
            figure, draw, frames=pictures(seconds, rate), interval=1000.0 / rate, blit=False
        )
        if path is not None:
            save_animation(animation, path, rate)
    return animation


def _animation_class() -> type[FuncAnimation]:
    from matplotlib import rc_context
    from matplotlib.animation import FuncAnimation

    class Animation(FuncAnimation):
        """An animation that a notebook displays with a player."""

        def __repr__(self) -> str:
            return "Animation: a notebook shows it with its player, .save(FILE) writes it"

        def _repr_html_(self) -> str:
            with rc_context({"savefig.dpi": DPI}):
                return self.to_jshtml()

    return Animation


def pictures(seconds: float, rate: int) -> int:
    """Return the number of frames of an animation, for its duration in seconds and frames per second.

    Raises
    ------
    ValueError
        If one of the numbers is not positive.
    """
    if not (math.isfinite(seconds) and seconds > 0.0 and rate >= 1):
        raise ValueError(f"seconds = {seconds!r} and rate = {rate!r} must be positive")
    return max(2, round(seconds * rate))


def save_animation(animation: FuncAnimation, path: str | Path, rate: int) -> Path:
    """Write an animation in the format given by the ending of the file name.

    Parameters
    ----------
    animation : FuncAnimation
    path : path
    rate : int
        Frames per second.

    Raises
    ------
    ValueError
        As `check_animation`, or if the file cannot be written.
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
