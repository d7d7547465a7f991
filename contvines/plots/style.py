"""The one style of all pictures, the marks of special points, and how a figure is made and saved."""

import re
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

STYLE = Path(__file__).with_name("contvines.mplstyle")

# line styles of the three states of an orbit
LINES: dict[str, Any] = {"stable": "-", "unstable": (0, (5, 2.2)), "virtual": (0, (1, 1.8))}
STATES = {"stable": "stable", "unstable": "unstable", "virtual": "virtual (beyond a border)"}


@dataclass(frozen=True)
class Mark:
    """How a kind of special point is drawn."""

    name: str
    marker: str
    filled: bool = False


MARKS = {
    "fold": Mark("fold", "s", True),
    "symmetry-breaking": Mark("symmetry breaking", "D"),
    "branch-point": Mark("branch point", "o"),
    "period-doubling": Mark("period doubling", "^"),
    "neimark-sacker": Mark("Neimark-Sacker", "p"),
    "hopf": Mark("Hopf", "h"),
    "velocity-graze": Mark("velocity graze", "v", True),
    "wall-graze": Mark("wall graze", ">", True),
    "stick": Mark("turn to stick", "<", True),
    "chatter": Mark("vanishing event", "X", True),
    "user": Mark("user function", "*", True),
    "end": Mark("end of the interval", "|"),
}
PLAIN = Mark("special point", "o")

# axis labels in the field's notation; anything else is shown by its own name
SYMBOLS = {
    "amplitude": "amplitude $C$",
    "C2": "$C^2$",
    "B": "velocity at the first impact $B$",
    "B_post": "velocity after impact $B^+$",
    "B_pre": "velocity before impact $B^-$",
    "B_mean": "mean velocity at impacts $B$",
    "max_abs_w": r"largest $|w|$",
    "max_abs_q1": r"largest $|q_1|$ in units of $b$",
    "phase": r"forcing phase at the first event",
    "impact_loss": "loss at impacts per period of the orbit",
    "friction_loss": "loss by friction per period of the orbit",
    "input_work": "work of the excitation per period of the orbit",
    "damping_loss": "loss in the damper per period of the orbit",
    "impact_loss_mean": "loss at impacts per forcing period",
    "friction_loss_mean": "loss by friction per forcing period",
    "input_work_mean": "work of the excitation per forcing period",
    "damping_loss_mean": "loss in the damper per forcing period",
    "impact_speed": "fastest impact $|w'_-|$",
    "frequency": r"frequency $\Omega$",
    "restitution": "restitution $r$",
    "friction": r"friction $\mu$",
    "gravity": r"gravity $\tilde g$",
    "mass_ratio": r"mass ratio $\varepsilon$",
    "forcing": "forcing $G$",
    "damping": r"damping $\lambda$",
}


# the same in words, for axes that have a unit
WORDS = {
    "max_abs_q1": "largest displacement of the oscillator",
    "max_abs_w": "largest relative displacement",
    "amplitude": "amplitude",
    "impact_speed": "fastest impact",
    "half_width": "half-width of the cavity (clearance to either side)",
    "frequency": "excitation frequency",
    "base_amplitude": "amplitude of the base",
    "force_amplitude": "amplitude of the force",
}


def axis_label(name: str, unit: str | None = None) -> str:
    """The label of an axis that shows `name`, counted in `unit` if it has one."""
    if not unit:
        return SYMBOLS.get(name, name.replace("_", " "))
    words = WORDS.get(name) or SYMBOLS.get(name, name.replace("_", " "))
    return f"{words} [{pretty(unit)}]"


def pretty(unit: str) -> str:
    """A unit as it is printed: m/s^2 with its exponent raised."""
    return re.sub(r"\^(-?\d+)", r"$^{\1}$", unit)


@contextmanager
def styled() -> Iterator[None]:
    """Draw in the package's style, leaving the user's settings as they were."""
    import matplotlib.style

    with matplotlib.style.context(["default", STYLE]):
        yield


def new_axes(axes: "Axes | None", **figure: Any) -> "tuple[Figure, Axes]":
    """The figure and axes to draw on: the given ones, or new ones that no window manager holds."""
    if axes is not None:
        return axes.get_figure(root=True), axes  # type: ignore[return-value]
    made = new_figure(**figure)
    return made, made.add_subplot()


def new_figure(**options: Any) -> "Figure":
    """A figure that needs no window and no closing; one of pyplot's where pyplot shows windows."""
    if _windows():
        return sys.modules["matplotlib.pyplot"].figure(**options)
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    made = Figure(**options)
    FigureCanvasAgg(made)
    return made


def settle(figure: "Figure") -> None:
    """Give everything its place."""
    figure.draw_without_rendering()


def freeze(figure: "Figure") -> None:
    """Leave everything where it is: a figure without a window is not laid out again."""
    if not _windows():
        figure.set_layout_engine("none")


def _windows() -> bool:
    """Whether the user's session shows pyplot's figures in windows (notebooks show what is returned)."""
    if "matplotlib.pyplot" not in sys.modules:
        return False
    backend = sys.modules["matplotlib.pyplot"].get_backend().lower()
    return backend not in ("agg", "cairo", "pdf", "pgf", "ps", "svg", "template") and "inline" not in backend


def save_figure(figure: "Figure", path: str | Path) -> None:
    """Save a figure; the name's ending chooses the format.

    Raises
    ------
    ValueError
        If the ending is not one that can be written, or the place cannot be.
    """
    path = Path(path)
    check_picture(path)
    with styled():
        try:
            figure.savefig(path)
        except OSError as error:
            raise ValueError(f"{path}: the picture cannot be written ({error.strerror}).") from None


def check_picture(path: str | Path) -> None:
    """Refuse, before any work, a picture that could not be written at the end."""
    path = Path(path)
    kinds = ("png", "pdf", "svg", "jpg", "eps")
    if path.suffix.lower().lstrip(".") not in kinds:
        raise ValueError(
            f"{path}: a picture's name must end in .{', .'.join(kinds)}; {path.stem}.png would do."
        )
    if not path.parent.is_dir():
        raise ValueError(
            f"{path}: there is no folder {str(path.parent)!r}; make it first, or choose another place."
        )
