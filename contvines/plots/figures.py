"""Save figures, and check their file names before any work. New figures and their layout are in `contvines.shared.figures`."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from contvines.shared.figures import is_frozen, styled
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
    check_picture(path)
    with styled({"figure.constrained_layout.use": False}):
        if is_frozen(figure):
            figure.set_layout_engine(None)  # the layout is final: an engine would draw everything once more
        try:
            figure.savefig(path)
        except OSError as error:
            raise ValueError(f"{path}: the picture cannot be written ({error.strerror}).") from None


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
