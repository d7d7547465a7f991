"""`contvines design STUDY.toml`: design figures of the study's machine in physical units, as a table and a picture."""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, NamedTuple

import numpy as np

from orbits.design.figures import Design

from ..shared.numbers import figures
from ..text_table import Table, titled
from .frame import draw as draw_in
from .frame import tell
from .options import JsonOption, StudyArgument, inches, option, picture
from .study import StudyError, read_study
from .study_data import Sort, Study

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from orbits.arguments import Reals

DAMPING = 0.9  # assumed for the reduced model, which has none; the default of the coupled model
HALF_WIDTH = 0.02  # metres: assumed half-width of a dimensionless machine without a scale
LEVELS = 10  # approximate number of contours of a map
DECADES = 8.0  # ratio of the largest to the smallest number from which on contours are logarithmic
MM = 1000.0  # millimetres per metre
BLUE, RED = "#0b3c6f", "#b5121b"


def machine(
    study: Study, cavity: float | None, natural_frequency: float | None
) -> tuple[Design, dict[str, str]]:
    """Return the study's machine on a physical scale, and the assumptions beyond the study, a sentence by name of the quantity.

    ``gravity`` = g/(b omega_0^2) ties the cavity's half-width b to the natural frequency: one of the two
    is enough (`HALF_WIDTH` if none is given). Without gravity both are needed.

    Raises
    ------
    StudyError
        If the scale is missing, given twice, or out of range.
    """
    from orbits.design.figures import SCALE

    model, physical = study.model, study.sort is Sort.PHYSICAL
    if not physical and study.sort is not Sort.CATALOGUE:
        raise StudyError(
            f"{study.path}: [model] name = {study.name!r}: design figures are closed forms of the built-in absorbers; "
            "contvines survey asks many machines of a declared machine."
        )
    params = model.vector(study.loose)
    slope = float(model.column(params, "slope")) if "slope" in model.parameter_names else 0.0
    if slope:
        raise StudyError(
            f"{study.path}: slope = {slope:g} rad: design figures are closed forms of level cavities; use slope = 0, and contvines survey "
            "or transient for the inclined one."
        )
    asked = (("half-width", cavity, "m", HALF_WIDTH), ("natural-frequency", natural_frequency, "Hz", 7.666))
    for name, value, unit, example in asked:
        if value is not None and physical:
            raise StudyError(f"--{name} = {value!r}: the study says it already; leave --{name} out.")
        if value is not None and not SCALE[0] <= value <= SCALE[1]:
            raise StudyError(
                f"--{name} = {value!r} is out of range; expected a number from {SCALE[0]:g} to {SCALE[1]:g} {unit}, "
                f"for example {example}."
            )
    numbers, assumed = model.named(params) if physical else study.parameters, {}
    fields: dict[str, Any] = {name: numbers[name] for name in ("restitution", "friction", "mass_ratio")}
    fields["damping"], gravity = numbers.get("damping", DAMPING), numbers["gravity"]
    if physical:
        b, rate = numbers["half_width"], numbers["natural_rate"]
        cavity, natural_frequency, fields["acceleration"] = b, rate / (2.0 * math.pi), gravity * b * rate**2
    elif gravity != 0:
        if cavity is not None and natural_frequency is not None:
            raise StudyError(
                f"--half-width and --natural-frequency were both given, but [model] gravity = {gravity!r} "
                "already ties one to the other; give one of them."
            )
        assumed["acceleration"] = f"gravity is {Design.acceleration:g} m/s^2"
        if cavity is None and natural_frequency is None:
            cavity = HALF_WIDTH
            assumed["half_width"] = (
                f"the half-width of the cavity is {MM * HALF_WIDTH:g} mm, because the study is dimensionless; all lengths "
                "are proportional to it; --half-width METRES or --natural-frequency HERTZ gives the machine's own"
            )
    else:
        fields["acceleration"] = 0.0
    if "damping" not in numbers:
        assumed["damping"] = f"the oscillator's damping is lambda = {DAMPING:g}, because the study gives none"
    if "acceleration" not in fields:
        try:
            return Design.from_dimensionless(
                gravity=gravity, cavity=cavity, natural_frequency=natural_frequency, **fields
            ), assumed
        except ValueError as error:
            raise StudyError(f"{study.path}: [model] {error}") from None
    if cavity is None or natural_frequency is None:
        raise StudyError(
            "[model] gravity = 0 fixes no scale; give both --half-width and --natural-frequency."
        )
    return Design(half_width=cavity, natural_frequency=natural_frequency, **fields), assumed


def rows(design: Design, assumed: Collection[str] = ()) -> list[tuple[str, str, str, str, str]]:
    """Return the rows of the table: name, symbol, value, unit, meaning; lengths in millimetres. `assumed`: names of assumed quantities."""
    half, damped = "half_width" in assumed, "damping" in assumed
    given = [
        ("half-width of cavity", "b", MM * design.cavity, "mm", f"{'assumed; ' if half else ''}wall to wall is 2 b"),
        ("natural frequency", "f_0", design.natural_frequency, "Hz", f"oscillator alone{'; follows from b' if half else ''}"),
        ("restitution", "r", design.restitution, "", "study"),
        ("friction", "mu", design.friction, "", "study"),
        ("mass ratio", "eps", design.mass_ratio, "", "study"),
        ("damping", "lambda", design.damping, "", "assumed" if damped else "study"),
    ]  # fmt: skip
    for line in design.figures():
        factor, unit = (MM, "mm") if line.unit == "m" else (1.0, line.unit.replace("1", ""))
        given.append((line.name, line.symbol, factor * float(line.value), unit, line.meaning))
    return [(name, symbol, figures(value), unit, meaning) for name, symbol, value, unit, meaning in given]


def as_json(design: Design, assumed: Mapping[str, str]) -> dict[str, Any]:
    """Return the figures in SI units at full precision, and the assumptions."""
    found: dict[str, Any] = {
        "assumed": assumed,
        "cavity": {"value": float(design.cavity), "unit": "m"},
        "natural_frequency": {"value": float(design.natural_frequency), "unit": "Hz"},
    }
    for line in design.figures():
        found[line.symbol] = {"value": float(line.value), "unit": line.unit, "meaning": line.meaning}
    return found


def draw(design: Design, size: tuple[float, float] | None = None, assumed: Collection[str] = ()) -> Figure:
    """Draw amplitude bounds and operating ratio over friction and over the cavity's half-width, and a map over both.

    Parameters
    ----------
    design : Design
    size : (float, float), optional
        Inches; a small figure has only the bounds over friction.
    assumed : collection of str
        Names of assumed quantities; an assumed half-width is mentioned above the figure.
    """
    from ..shared.figures import new_figure, settle, styled, thin_ticks

    mu0, b0 = float(design.friction), float(design.cavity)
    mu = np.linspace(0.0, max(2.0 * mu0, 0.3), 201)
    b = np.linspace(0.35, 2.0, 201) * b0
    columns = (
        Variation(mu, "friction", mu0, r"friction $\mu$", 1.0),
        Variation(b, "cavity", b0, "half-width $b$ [mm]", MM),
    )
    size = size or (10.5, 6.6)
    small = size[0] < 6.0 or size[1] < 4.0
    with styled():
        figure = new_figure(figsize=size)
        if "half_width" in assumed:
            figure.suptitle(f"lengths for an assumed half-width $b$ = {MM * b0:g} mm", fontsize="small")
        if small:
            axes = figure.add_subplot()
            _bounds(axes, design, columns[0], 1.9)
            axes.set_xlabel(columns[0].label)
            axes.legend(loc="upper left")
            settle(figure)
            thin_ticks(axes)
            return figure
        top, bottom = figure.subplots(2, 3, width_ratios=(1, 1, 1.15))
        for upper, lower, over, room in zip(top, bottom, columns, (1.0, 1.45)):
            _bounds(upper, design, over, room)
            ratio = design.with_(**{over.name: over.values}).operating_ratio
            lower.plot(over.values * over.unit, ratio, color=BLUE)
            lower.set(xlabel=over.label, ylim=(1, None))
            _mark_own(lower, over)
        bottom[0].set_ylabel(r"operating ratio $\xi$")
        top[1].set_ylabel("")
        top[1].legend(loc="upper left")
        over = design.with_(friction=mu[None, :], cavity=b[:, None])
        _map(top[2], mu, b, over.upper_bound * MM, (mu0, b0), r"upper bound $q_{1,\max}$ [mm]")
        _map(bottom[2], mu, b, over.operating_ratio, (mu0, b0), r"operating ratio $\xi$")
        bottom[2].set_xlabel(columns[0].label)
    return figure


class Variation(NamedTuple):
    """A quantity that varies: its values, its field of `Design`, the design's own value, an axis label, and the factor to the label's unit."""

    values: np.ndarray
    name: str
    own_value: float
    label: str
    unit: float


def _bounds(axes: Axes, design: Design, over: Variation, room: float) -> None:
    """Draw the amplitudes of the oscillator between which two symmetric impacts exist, and those at which the absorber sticks.

    `room` is the space for a legend.
    """
    values_shown, line = over.values * over.unit, design.with_(**{over.name: over.values})
    limits = line.activation_threshold, line.upper_bound, line.sticking_limit()
    low, high, stick = (MM * np.broadcast_to(limit, values_shown.shape) for limit in limits)
    axes.fill_between(values_shown, low, high, color="#dbe6f1", lw=0, label="two symmetric impacts")
    for values, color, style, label in (
        (low, BLUE, "-", r"activation threshold $q_{1,\min}$"),
        (high, BLUE, (0, (5, 2.2)), r"upper bound $q_{1,\max}$"),
        (stick, RED, (0, (1, 1.6)), r"sticking limit $q_{1,\mathrm{cr}}$ at $f_0$"),
    ):
        axes.plot(values_shown, values, color=color, ls=style, label=label)
    axes.set(ylabel="oscillator $q_1$ [mm]", ylim=(0, 1.05 * room * max(np.max(high), np.max(stick))))
    _mark_own(axes, over)


def _mark_own(axes: Axes, over: Variation) -> None:
    axes.axvline(over.own_value * over.unit, color="#5e5e5e", lw=0.8, ls=(0, (3, 3)))


def _round_levels(low: float, high: float) -> Sequence[float]:
    """Return round values that cover an interval: in even steps, or by decades (1, 2, 5) if the ends differ much."""
    from matplotlib.ticker import LogLocator, MaxNLocator

    if high > DECADES * low > 0.0:
        return LogLocator(subs=(1.0, 2.0, 5.0), numticks=LEVELS).tick_values(low, high)
    return MaxNLocator(nbins=LEVELS, steps=[1, 2, 2.5, 5, 10]).tick_values(low, high)


def _map(
    panel: Axes, mu: np.ndarray, b: np.ndarray, values: Reals, own: tuple[float, float], title: str
) -> None:
    """Draw the contours of a quantity over friction and half-width."""
    values = np.asarray(values)
    finite = values[np.isfinite(values)]  # elastic walls without friction have no threshold and no ratio
    if finite.size and finite.max() > 1.001 * finite.min():
        levels = _round_levels(float(finite.min()), float(finite.max()))
        masked = np.ma.masked_invalid(values)
        panel.contourf(mu, MM * b, masked, levels=levels, cmap="Greys", alpha=0.55, norm="log")
        lines = panel.contour(mu, MM * b, masked, levels=levels, colors=BLUE, linewidths=0.9)
        panel.clabel(lines, fmt="%.3g", fontsize=7.5)
    panel.plot(own[0], MM * own[1], "o", color=RED)
    panel.set(ylabel="half-width $b$ [mm]", title=title)
    panel.grid(False)


def design(
    study: StudyArgument,
    cavity: Annotated[
        float | None, option("--half-width, --cavity", "Half-width b of the cavity [m]; by default 0.02.")
    ] = None,
    natural_frequency: Annotated[
        float | None,
        option(
            "--natural-frequency",
            "Natural frequency f_0 of the oscillator [Hz], in place of --half-width.",
        ),
    ] = None,
    plot: Annotated[
        Path | None,
        option("--plot FILE.png", "Picture; by default STUDY-design.png in this folder.", callback=picture),
    ] = None,
    size: Annotated[
        tuple[float, float] | None,
        option(
            "--size WIDTH HEIGHT",
            "Size of the picture in inches; a small one shows only the bounds over friction.",
            callback=inches,
        ),
    ] = None,
    no_plot: Annotated[bool, option("--no-plot", "No picture.")] = False,
    json_: JsonOption = False,
) -> None:
    """Design figures in physical units: activation threshold, upper bound, operating ratio, sticking and
    sliding limits."""
    if no_plot and plot is not None:
        raise ValueError(f"--plot {plot} and --no-plot exclude each other; leave one of them out.")
    asked = read_study(study)
    figures, assumed = machine(asked, cavity, natural_frequency)
    heads = ("quantity", "symbol", "value", "unit", "meaning")
    title = "\n".join(
        [f"Design figures of {study.name}", *(f"assumed: {sentence}" for sentence in assumed.values())]
    )
    table = titled(title, Table(heads, rows(figures, assumed), ("meaning",), ("value",)))
    tell(table, as_json(figures, assumed) if json_ else None)
    if not no_plot:
        draw_in(plot or Path(f"{study.stem}-design.png"), lambda: draw(figures, size, assumed))
