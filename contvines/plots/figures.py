"""Save figures; check file names, styles and sizes before any work. New figures and their layout are in `contvines.shared.figures`."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from contvines.shared.figures import is_frozen, styled
from contvines.shared.figures import new_figure as new_figure
from contvines.shared.figures import settle as settle
from contvines.shared.files import refuse_place

if TYPE_CHECKING:
    from matplotlib.figure import Figure

FORMATS = ("png", "pdf", "svg", "jpg", "eps")


def save_figure(figure: Figure, path: str | Path) -> None:
    """Save a figure in the format given by the ending of the file name.

    Raises
    ------
    ValueError
        If the ending is unknown, or the file cannot be written.
    """
    path = Path(path)
    check_picture(path)
    with styled({"figure.constrained_layout.use": False}):
        if is_frozen(figure):
            figure.set_layout_engine(None)  # the layout is final: an engine would draw everything once more
        try:
            figure.savefig(path)
        except OSError as error:
            raise ValueError(f"{path}: the picture cannot be written ({error.strerror}).") from None


def check_style(style: str | None) -> None:
    """Raise an error for a style that does not exist.

    Raises
    ------
    ValueError
    """
    with styled(style):
        pass


def check_size(size: tuple[float, float] | None) -> None:
    """Raise an error for an impossible size of a picture in inches.

    Raises
    ------
    ValueError
        If width or height is not between 1 and 60.
    """
    if size is not None and not all(1.0 <= side <= 60.0 for side in size):
        raise ValueError(f"--size {size[0]:g} {size[1]:g}: give inches between 1 and 60, such as 3.4 2.4.")


def check_picture(path: str | Path) -> None:
    """Raise an error for the name of a picture that cannot be written.

    Raises
    ------
    ValueError
        If the ending is unknown, or the folder does not exist.
    """
    path = Path(path)
    if path.suffix.lower().lstrip(".") not in FORMATS:
        raise ValueError(f"{path}: a picture's name must end in .{', .'.join(FORMATS)}; use {path.stem}.png.")
    refuse_place(path)
