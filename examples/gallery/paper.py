"""What the scripts of this folder share: the paper's machines, its scales, and one way to draw and to report.

Source of all figures: B. Youssef, A. Y. Karoui, R. I. Leine, "The effect of friction on the dynamics of
targeted energy transfer by symmetric vibro-impact dampers". The oscillator's damping is not printed
there. The scripts take ``lambda = c/(m omega_0) = 0.9`` (damping ratio 0.27 %): with it the simulated
claims of the paper come true at its own parameters (G = 3.3: symmetric impacts at Omega = 0.977,
asymmetric at 0.983; G = 2.47, sigma = -2.58: sliding from rest, impacting from q1 = q2 = b; sigma =
-9.04: stick-slip). Its half-width b = 0.02 m is printed, the natural frequency f_0 = 7.666 Hz follows
from "sigma = -9.04 (f = 7.25 Hz)".
"""

from __future__ import annotations

import argparse
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from contvines.plots.legends import place_legend
from contvines.shared.figures import new_figure, settle, styled

MASS_RATIO = 0.006
DAMPING = 0.9
HALF_WIDTH = 0.02  # m
NATURAL_FREQUENCY = 7.666  # Hz
STRONG = {"restitution": 0.76, "friction": 0.5, "gravity": 0.211, "mass_ratio": MASS_RATIO}
WEAK = {"restitution": 0.76, "friction": 0.1, "gravity": 0.422, "mass_ratio": MASS_RATIO}
MIDDLE = {"restitution": 0.76, "friction": 0.3, "gravity": 0.355, "mass_ratio": MASS_RATIO}

BLUE, RED, GREEN, PURPLE, GREY, PALE = "#0b3c6f", "#b5121b", "#1b7837", "#7b3294", "#5e5e5e", "#9db8d2"
DASHED, DOTTED, DOT_DASHED = (0, (5, 2.2)), (0, (1, 1.8)), (0, (6, 2, 1, 2))
COLUMN = 5.0  # inches: in a narrower picture panels stand one above another and legends below
width: float | None = None  # of the picture that is being drawn, inches; None: as wide as the script has it
_legends: list[Any] = []  # axes of the picture that is being drawn


def narrow() -> bool:
    """Whether the picture is to fit a journal's column."""
    return width is not None and width < COLUMN


def figure(wide: float = 7.2, high: float = 4.6) -> Figure:
    """A figure without a window, in inches; all of it smaller where `width` asks for that."""
    return new_figure((wide, high) if width is None else (width, width * max(high / wide, 0.706)))


def panels(wide: float, high: float, rows: int, columns: int, **sharing: Any) -> tuple[Figure, Any]:
    """A figure of `wide` x `high` inches and its panels, shape (rows, columns); at most two beside one another in a column."""
    if not narrow():
        made = figure(wide, high)
        return made, made.subplots(rows, columns, squeeze=False, **sharing)
    assert width is not None
    count = rows * columns
    across = 1 if count < 4 else 2
    made = new_figure((width, width * (0.62 if across == 1 else 0.45) * count / across))
    if across != columns:
        sharing = {}
    return made, made.subplots(count // across, across, squeeze=False, **sharing).reshape(rows, columns)


def legend(axes: Any, **options: Any) -> None:
    """A legend inside the axes; where the picture is narrow, below them."""
    _legends.append(axes)
    if not narrow():
        axes.legend(**options)


def _fit(picture: Figure) -> None:
    """Smaller marks and legends below, where the picture is narrow."""
    for line in picture.findobj(Line2D) if narrow() else []:
        line.set_markersize(min(line.get_markersize(), 4.3))  # type: ignore[attr-defined]
    settle(picture)
    for axes in (
        2 * _legends if narrow() else []
    ):  # twice: a second legend moves what the first stands beneath
        handles = axes.get_legend_handles_labels()[0]
        unlike = list({str(h.get_label()): h for h in handles}.values())
        place_legend(axes, unlike, "below", own=len(picture.axes) == 1)
    _legends.clear()


def coupled(forcing: float, *, detuning: float | None = None, frequency: float | None = None, **changes: Any):
    """The coupled machine, strong friction unless changed."""
    from orbits import Coupled

    fields = {**STRONG, "damping": DAMPING, **changes}
    if frequency is None:
        frequency = 1.0 + fields["mass_ratio"] * (detuning or 0.0)
    return Coupled(forcing=forcing, frequency=frequency, **fields)


def on_manifold(machine: Any, amplitude: float) -> dict[str, float]:
    """A start on the impacting manifold at amplitude C, at an impact on the left wall."""
    from orbits import multiple_scales as ms

    loss, level = ms.impact_loss(machine.restitution), ms.friction_level(machine.friction, machine.gravity)
    b = float(ms.velocity_at(amplitude, loss, level))
    sine, cosine = 1.0 - 0.5 * np.pi * b, float(loss * b + level)
    return {"w": 1.0, "w_rate": cosine - (b + float(level)), "v": sine, "v_rate": cosine}


def at_equilibrium(machine: Any, state: Any) -> dict[str, float]:
    """A start at an impacting steady state of the slow flow, at an impact on the left wall."""
    from orbits import multiple_scales as ms

    start = on_manifold(machine, state.amplitude)
    b, level = state.velocity, float(ms.friction_level(machine.friction, machine.gravity))
    sine, cosine = 1.0 - 0.5 * np.pi * b, float(ms.impact_loss(machine.restitution) * b + level)
    start |= {"w_rate": cosine - (b + level), "v": sine, "v_rate": cosine * machine.frequency}
    return start | {"phase": float((np.arctan2(sine, cosine) - state.phase) % (2 * np.pi))}


def slow_variables(run: Any) -> dict[str, np.ndarray]:
    """Slow variables at the impacts of a simulated motion, each shape (impacts,).

    ``time`` eps tau, ``before`` and ``after`` the absorber's absolute speed (times 1 + eps), ``B`` their
    mean, ``C2`` from v and v', ``gamma`` the phase of v relative to the forcing.
    """
    omega, eps = run.model.frequency, run.model.mass_ratio
    rows = run.rows[run.codes < 2]
    side = np.where(rows[:, 2] > 0, 1.0, -1.0)
    before, after = side * (rows[:, 3] - rows[:, 6]), side * (rows[:, 6] - rows[:, 4])
    amplitude = rows[:, 5] + 1j * rows[:, 6] / omega
    phase = np.arctan2(rows[:, 5], rows[:, 6] / omega) - rows[:, 0]
    first = run.start[0] + 2 * np.pi * run.start[4]
    return {
        "time": eps * (rows[:, 0] + 2 * np.pi * rows[:, 1] - first) / omega,
        "B": 0.5 * (before + after), "before": before, "after": after,
        "C2": np.abs(amplitude) ** 2, "gamma": np.angle(np.exp(1j * phase)),
    }  # fmt: skip


def peak(attractor: Any) -> float:
    """Largest |q1| of a motion that recurs (or over 64 periods of one that does not)."""
    from orbits.simulation import simulate

    return simulate(attractor.model, attractor.state, periods=max(1, attractor.periods or 64)).peak_cavity()


def sampled(run: Any, per_period: int) -> Any:
    """A simulated motion at even instants, and just before and after its events: an impact is a step at a wall."""
    events = run.rows[:, 0] + 2 * np.pi * run.rows[:, 1]
    span = run.sample(per_period=per_period).phase
    return run.sample(np.unique(np.concatenate([span, events - 1e-9, events]).clip(span[0], span[-1])))


def portrait(panels: Any, machine: Any, state: Any, periods: int, *, color: str = BLUE) -> None:
    """Displacement of the absorber over time and its phase portrait, on two axes."""
    from orbits.simulation import simulate

    seen = sampled(simulate(machine, state, periods=periods), 600)
    turns = (seen.phase - seen.phase[0]) / (2 * np.pi)
    history, plane = panels
    history.plot(turns, seen.w, color=color, label="absorber in its cavity $w$")
    history.plot(turns, seen.cavity, color=GREY, lw=1.0, ls=DASHED, label="oscillator $q_1/b$")
    history.set(ylabel="$w$, $q_1/b$", xlabel="forcing periods")
    for wall in (-1, 1):
        history.axhline(wall, color="k", lw=0.7)
        plane.axvline(wall, color="k", lw=0.7)
    plane.plot(seen.w, seen.w_rate, color=color)
    plane.set(xlabel="$w$", ylabel="$w'$")
    plane.set_xticks((-1, 0, 1))
    plane.invert_xaxis()  # the left wall, w = +1, on the left


def run(
    name: str, main: Callable[[], tuple[Figure, dict[str, Any]]], folder: Path | None = None
) -> dict[str, Any]:
    """Draw, save `name`.png, print the numbers; returns them.

    Parameters
    ----------
    name : str
        Name of the picture and title of the report.
    main : callable
        () -> figure and numbers.
    folder : Path, optional
        Where the picture goes; from the command line if not given, else the folder ``pictures``.
    """
    global width
    wanted = width
    if folder is None:
        parser = argparse.ArgumentParser(description=f"Draws {name}.png and prints what it shows.")
        parser.add_argument("folder", nargs="?", type=Path, default=Path("pictures"), help="output folder")
        parser.add_argument("--width", type=float, help="inches, such as 3.4 for a column of a journal")
        given = parser.parse_args()
        folder = Path(given.folder)
        wanted = given.width
    folder.mkdir(parents=True, exist_ok=True)
    with styled():
        width = wanted
        picture, numbers = main()
        _fit(picture)
        picture.savefig(folder / f"{name}.png", dpi=130 if not narrow() else 225)
    print(f"{name}: {folder / f'{name}.png'}")
    for what, value in numbers.items():
        shown = f"{value:.6g}" if isinstance(value, float) else value
        print(f"  {what}: {shown}")
    return numbers
