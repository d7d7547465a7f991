"""`contvines recommend STUDY.toml`: recommend a clearance with its tolerance, benefits and costs, and draw the pictures."""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

from .frame import draw, held, interruptible, place_of, say, tell
from .options import (
    FreshOption,
    JsonOption,
    PlotOption,
    QuietOption,
    SizeOption,
    argument,
    option,
)
from .recommendation import Recommendation

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from .study_data import Study

BLUE, RED, GREY = "#0b3c6f", "#b5121b", "0.45"
SIZE, REPORT = (10.0, 4.0), (9.0, 3.4)  # inches
HEADROOM = 1.1  # upper end of the vertical axis, relative to the largest number
PART = 0.6  # height of the start-up's picture, relative to the others


def recommend(
    study: Annotated[
        Path,
        argument("STUDY.toml", "A study; its [survey] vary names the free and the uncertain parameters."),
    ],
    cost: Annotated[
        float,
        option("--cost PERCENT", "Largest loss of performance within the tolerance.", min=0.1, max=50.0),
    ] = 5.0,
    target: Annotated[
        str | None,
        option(
            "--target LENGTH",
            'Response that is small enough, "30 mm"; by default 0.9 of that without absorber.',
        ),
    ] = None,
    workers: Annotated[
        int | None,
        option("--workers", "Number of processes on this computer; by default one per core.", min=1),
    ] = None,
    output: Annotated[
        Path | None,
        option("-o, --output FILE.json", "Result file; by default STUDY-recommend.json in this folder."),
    ] = None,
    plot: PlotOption = None,
    size: SizeOption = None,
    fresh: FreshOption = False,
    json_: JsonOption = False,
    quiet: QuietOption = False,
) -> None:
    """Recommend a clearance: theory first, then diagrams of all samples; an interrupted run goes on.

    The free parameter is the one that [survey] vary has on a grid (half_width
    if there is none). Its best value has the lowest worst response over all
    coexisting motions and all samples of the uncertain parameters.
    """
    from .study import read_study

    read = read_study(study)
    place = place_of(output, study, "-recommend.json")
    goal = None if target is None else _target(target, read)
    with held(place, quiet, fresh):
        found = recommended(read, place, cost / 100.0, goal, workers, quiet)
    if json_ or not quiet:
        tell(found, found.to_dict() if json_ else None)
    draw(plot, lambda: choice_picture(found, size), quiet)


def recommended(
    read: Study, place: Path, cost: float, target: float | None, workers: int | None, quiet: bool
) -> Recommendation:
    """Return the recommendation for a study, from its file if that is finished, otherwise computed, with journals of the rows beside the file."""
    from ..export import json_text
    from .recommending import digest
    from .recommending import recommend as run

    expected = digest(read, cost, target)
    if place.exists():
        stored = kept(place)
        if stored.get("digest") != expected:
            raise ValueError(
                f"{place}: this file holds another recommendation (or this one before the study was edited); --fresh sets it aside, "
                "-o gives another name."
            )
        say(f"{place} holds the finished recommendation; nothing to compute.", quiet)
        return Recommendation.from_dict(stored["recommendation"])
    journals: list[Path] = []

    def journal(count: int) -> Path:
        journals.append(place.with_name(f"{place.name}.{count}.unfinished"))
        return journals[-1]

    with interruptible("all finished machines are kept; the same command goes on from there"):
        found = run(
            read, cost=cost, target=target, workers=workers, journal=journal, tell=lambda text: say(text, quiet), progress=not quiet
        )  # fmt: skip
    place.write_text(json_text({"digest": expected, "recommendation": found.to_dict()}), encoding="utf-8")
    for path in journals:
        path.unlink(missing_ok=True)
    say(f"kept in {place}", quiet)
    return found


def kept(place: Path) -> dict[str, Any]:
    """Read a result file of this command.

    Raises
    ------
    ValueError
        If it is a file of another kind.
    """
    try:
        found = json.loads(place.read_text(encoding="utf-8"))
    except (OSError, ValueError):
        found = None
    if not isinstance(found, dict) or "recommendation" not in found:
        raise ValueError(f"{place}: this is not a file of contvines recommend; choose another name with -o.")
    return found


def _target(text: str, study: Study) -> float:
    from orbits.flows import flow_of

    from .compose import machine
    from .options import amount

    model = machine(study)
    value = amount("--target", text, flow_of(model).default_measure(model), model.units)
    if value <= 0.0:
        raise ValueError(f"--target {text}: give a response above 0.")
    return value


def choice_picture(found: Recommendation, size: tuple[float, float] | None = None) -> Figure:
    """Draw both panels, one above the other in a narrow picture, with a legend below; only the first panel if nothing was chosen."""
    from ..shared.figures import legend_below, panels

    arranged = ({"mosaic": "ab"}, {"mosaic": "a;b"}) if found.curves else ({"mosaic": "a"},)
    with panels(None, (), "", size or SIZE, None, *arranged) as (figure, drawn):
        draw_places(drawn[0], found)
        if len(drawn) > 1:
            draw_responses(drawn[1], found)
        entries = {str(h.get_label()): h for axes in drawn for h in axes.get_legend_handles_labels()[0]}
        legend_below(drawn[0], list(entries.values()), True)
    return figure


def _label(found: Recommendation, name: str, text: str) -> str:
    unit = found.units.get(name, "")
    return f"{text} [{unit}]" if unit else text


def draw_places(axes: Axes, found: Recommendation) -> None:
    """Draw the worst response over the parameter that is chosen."""
    from orbits.design.references import NAMES

    from ..plots.style import REFERENCES

    first = [p for p in found.places if p.samples < found.most or found.most == 1]
    complete = [p for p in found.places if p.samples == found.most > 1]
    for places, mark, label in (
        (first, "o", "the study's machine"),
        ([p for p in complete if not p.left], "D", f"worst of {found.most} samples"),
        ([p for p in complete if p.left], "^", "at least: one sample"),
    ):
        finite = [(p.value, p.worst) for p in places if math.isfinite(p.worst)]
        if finite:
            axes.plot(
                *zip(*finite),
                mark,
                color=BLUE,
                markersize=4,
                mfc=BLUE if mark == "D" else "white",
                label=label,
            )
    hidden = [p.value for p in found.places if p.unknown]
    if hidden:
        axes.plot(hidden, [0.0] * len(hidden), "x", color=GREY, label="not known", clip_on=False)
    for kind, (value, _) in found.compared.items():
        color, dashes = REFERENCES[kind]
        axes.axhline(value, color=color, linestyle=dashes, linewidth=1.2, label=NAMES[kind])
    if found.value is not None and found.chosen is not None:
        axes.axvspan(
            *found.tolerance, color=RED, alpha=0.1, lw=0, label=f"costs less than {100 * found.cost:g} %"
        )
        axes.plot(
            found.value, found.chosen.worst, "*", color=RED, markersize=13, mec="white", label="recommended"
        )
    if found.own is not None:
        axes.axvline(found.own, color=GREY, lw=0.9, ls=(0, (3, 3)), label="in the study")
    axes.set(
        xlabel=_label(found, found.name, found.name.replace("_", "-")),
        ylabel=_label(found, "peak", "largest response"),
        ylim=(0.0, HEADROOM * axes.dataLim.y1 or None),
    )


def draw_responses(axes: Axes, found: Recommendation) -> None:
    """Draw the responses at the choice and those of the machines for comparison."""
    from orbits.design.references import NAMES

    from ..plots.style import REFERENCES

    for curve in found.curves:
        if curve.name in REFERENCES:
            color, dashes = REFERENCES[curve.name]
            axes.plot(curve.x, curve.y, color=color, linestyle=dashes, linewidth=1.2, label=NAMES[curve.name])
    for name, style in (
        ("simulated", {"marker": ".", "ls": "", "ms": 2.5, "color": "0.35"}),
        ("stable", {"color": BLUE, "lw": 1.8}),
    ):
        label = {"simulated": "simulation up and down", "stable": "recommended: stable motions"}[name]
        for curve in (c for c in found.curves if c.name == name):
            axes.plot(curve.x, curve.y, label=label, **style)
            label = "_"
    axes.set(
        xlabel=_label(found, found.parameter, found.parameter.replace("_", " ")),
        ylabel=_label(found, "peak", "largest displacement"),
        ylim=(0.0, HEADROOM * axes.dataLim.y1),
        xlim=found.within,
    )


def report_pictures(found: Recommendation) -> list[tuple[Figure, str]]:
    """Return the pictures of the report with their captions."""
    import numpy as np

    from ..plots.measured import plot_transient

    pictures = [
        (
            choice_picture(found, REPORT),
            "Left: the largest response over the value that is chosen. Right: responses at the choice; where two solid lines run side by side, the machine's past decides.",
        )
    ]
    if found.start_up is not None and found.start_up.series:
        names = {"time": "time", "oscillator": "peak", "bare": "peak"}
        series = [
            (name, found.units.get(names[name], ""), np.array(values))
            for name, values in found.start_up.series.items()
        ]
        figure = plot_transient(series, figsize=(REPORT[0], REPORT[1] * PART))
        pictures.append((figure, f"Start-up from rest; {found.start_up_at}."))
    return pictures
