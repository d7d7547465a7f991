"""`contvines recommend STUDY.toml`: a clearance, how tolerant it is, what it brings and costs."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

from contvines.command.frame import beside, draw, held, interruptible, refuse_source, say, tell
from contvines.command.options import (
    FreshOption,
    JsonOption,
    PlotOption,
    QuietOption,
    SizeOption,
    argument,
    option,
)
from contvines.command.recommendation import Recommendation

if TYPE_CHECKING:
    from .study_data import Study


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
    from contvines.command.study import read_study

    read = read_study(study)
    place = output or beside(study, "-recommend.json")
    refuse_source(place, study)
    goal = None if target is None else _target(target, read)
    with held(place, quiet, fresh):
        found = recommended(read, place, cost / 100.0, goal, workers, quiet)
    if json_ or not quiet:
        tell(found, found.to_dict() if json_ else None)
    if plot is not None:
        from contvines.command.recommend_picture import choice_picture

        draw(plot, lambda: choice_picture(found, size), quiet)


def recommended(
    read: Study, place: Path, cost: float, target: float | None, workers: int | None, quiet: bool
) -> Recommendation:
    """The recommendation for a study: from its file if that is finished, else computed; rows of an unfinished one are kept beside it."""
    from contvines.command.recommending import digest
    from contvines.command.recommending import recommend as run

    own = digest(read, cost, target)
    if place.exists():
        known = kept(place)
        if known.get("digest") != own:
            raise ValueError(
                f"{place}: this file holds another recommendation (or this one before the study was edited); --fresh sets it aside, "
                "-o gives another name."
            )
        say(f"{place} holds the finished recommendation; nothing to compute.", quiet)
        return Recommendation.from_dict(known["recommendation"])
    journals: list[Path] = []

    def journal(count: int) -> Path:
        journals.append(place.with_name(f"{place.name}.{count}.unfinished"))
        return journals[-1]

    with interruptible("all finished machines are kept; the same command goes on from there"):
        found = run(
            read,
            cost=cost,
            target=target,
            workers=workers,
            journal=journal,
            tell=lambda text: say(text, quiet),
            progress=not quiet,
        )
    from contvines.export import json_text

    place.write_text(json_text({"digest": own, "recommendation": found.to_dict()}), encoding="utf-8")
    for path in journals:
        path.unlink(missing_ok=True)
    say(f"kept in {place}", quiet)
    return found


def kept(place: Path) -> dict[str, Any]:
    """What a file of this command holds.

    Raises
    ------
    ValueError
        If it is another file.
    """
    try:
        found = json.loads(place.read_text(encoding="utf-8"))
    except (OSError, ValueError):
        found = None
    if not isinstance(found, dict) or "recommendation" not in found:
        raise ValueError(f"{place}: this is not a file of contvines recommend; choose another name with -o.")
    return found


def _target(text: str, study: Study) -> float:
    from contvines.command.amounts import amount
    from orbits.flows.catalogue import flow_of

    model = study.model
    value = amount("--target", text, flow_of(model).default_measure(model), model.units)
    if value <= 0.0:
        raise ValueError(f"--target {text}: give a response above 0.")
    return value
