"""The built-in absorbers declared in a machine file, against themselves: the same words, the same special points, the same graph.

`python -m tools.pages.same_graph [friction] [friction_low] [frequency]` makes the diagrams of these example studies with
both and compares them: branches by word, periods and ends; special points by kind, value, whether they are real, and multipliers
(but at borders, where they depend on the side); and which branches meet at which point.

`python -m tools.pages.same_graph drawn absorber 50 SALT` does so with machines that :mod:`tools.fuzz.drawing` draws.
"""

import sys
import time
import tomllib
from collections.abc import Callable
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

import contvines as cv
from contvines.bifurcation.kinds import BORDERS
from orbits import Absorber, Coupled
from tools.fuzz.drawing import draw
from tools.pages.pages import page

EXAMPLES = Path(__file__).resolve().parents[2] / "examples"
BUILT_IN = {"absorber": Absorber, "coupled": Coupled}
STUDIES = ("friction", "friction_low", "frequency")
EXACT = "exact"  # the excitation that the page has
SAME = 1e-10
ENDS = 1e-9  # ends of branches: borders of both kinds are found from either side


class Differences(NamedTuple):
    """Special points in both graphs, the largest difference of their values and multipliers, and what differs."""

    points: int
    values: float
    multipliers: float
    sentences: list[str]


def both(name: str, **changed: Any) -> tuple[str, list[Any]]:
    """The machine of an example study, and its graphs: of the built-in machine and of its page."""
    study = tomllib.loads((EXAMPLES / f"{name}.toml").read_text())
    given, start = dict(study["model"]), dict(study["start"])
    settings = {**study["continue"], **changed}
    settings["over"] = settings.pop("parameter")
    kind, word, periods = given.pop("name"), start.pop("word"), start.pop("periods")
    machine = BUILT_IN[kind](**{k: v for k, v in given.items() if k in BUILT_IN[kind].field_names()})
    others = {**{k: v for k, v in given.items() if k not in BUILT_IN[kind].field_names()}, **start}
    first = machine.orbit(word, periods, **others)
    again = page(kind).orbit(word, periods, **given, **start)
    return kind, [cv.diagram(orbit, **settings) for orbit in (first, again)]


def drawn(kind: str, salt: int, seed: int, most: int = 40) -> list[Any]:
    """The graphs of a drawn machine, without its virtual branches; none for those that the page does not have, or that are cut at so many branches."""
    draws = draw(kind, salt, seed)
    given = {} if draws.orbit is None else dict(draws.orbit.parameters)
    if not given.get("friction") or given.pop("excitation", EXACT) != EXACT or not len(draws.orbit.word):
        return []
    options = {**draws.options, "virtual": False, "settings": {"max_branches": most}}
    first = cv.diagram(draws.orbit, **options)
    if not first.complete:
        return []
    again = page(kind).orbit(draws.orbit.spelling, draws.orbit.periods, **given)
    return [first, cv.diagram(again, **options)]


def compared(kind: str, built_in: Any, declared: Any) -> Differences:
    """What differs between the graph of a built-in machine and that of its page."""
    wrong: list[str] = []
    branches = _matched(built_in.branches, declared.branches, _branch(kind), ENDS, wrong)
    points = _matched(built_in.special, declared.special, _point, SAME, wrong)
    values = multipliers = 0.0
    for one, other in points.items():
        p, q = built_in.special[one], declared.special[other]
        values = max(values, abs(p.value - q.value))
        if p.kind not in BORDERS and p.kind != "end":
            a, b = (np.sort(np.abs(x.multipliers))[::-1] for x in (p, q))
            n = min(len(a), len(b))
            multipliers = max(multipliers, float(np.abs(a[:n] - b[:n]).max()))
        here, there = _meeting(built_in, one), _meeting(declared, other)
        if {branches.get(label, "") for label in here} != there:
            wrong.append(f"{one} joins {sorted(here)}, on the page {other} joins {sorted(there)}")
    return Differences(len(points), values, multipliers, wrong)


def _matched(
    here: Any,
    there: Any,
    told: Callable[[Any], tuple[Any, np.ndarray]],
    near: float,
    wrong: list[str],
) -> dict[str, str]:
    """Label -> label of what has the same form, and numbers as near as `near`, in the other graph."""
    found: dict[str, str] = {}
    left = {label: told(thing) for label, thing in there.items()}
    for label, thing in here.items():
        form, numbers = told(thing)
        gaps = {
            k: float(np.abs(numbers - others).max()) for k, (other, others) in left.items() if other == form
        }
        best = min(gaps, key=lambda k: gaps[k], default="")
        if not best or gaps[best] > near:
            wrong.append(f"{label} {form} at {numbers} is not on the page")
        else:
            found[label] = best
            del left[best]
    wrong += [f"{label} {form} at {numbers} is on the page alone" for label, (form, numbers) in left.items()]
    return found


def _branch(kind: str) -> Callable[[Any], tuple[Any, np.ndarray]]:
    def told(branch: Any) -> tuple[Any, np.ndarray]:
        word = branch.description["word"]
        events = page(kind).word(word).canonical().events if word else ()
        return (events, branch.description["periods"]), np.array([branch.values.min(), branch.values.max()])

    return told


def _point(point: Any) -> tuple[Any, np.ndarray]:
    return (point.kind, point.real), np.array([point.value])


def _meeting(graph: Any, label: str) -> set[str]:
    joined = {b for s in graph.switches if s.point == label for b in (s.source, s.target)}
    return joined | {graph.special[label].branch}


def main() -> None:
    """Compare the example studies, or drawn machines."""
    asked: list[tuple[str, Callable[[], tuple[str, list[Any]]]]]
    if sys.argv[1:2] == ["drawn"]:
        kind, count, salt = sys.argv[2], int(sys.argv[3]), int(sys.argv[4])
        asked = [(f"{kind} {n}", lambda n=n: (kind, drawn(kind, salt, n))) for n in range(count)]
    else:
        asked = [(name, lambda name=name: both(name)) for name in sys.argv[1:] or STUDIES]
    for name, make in asked:
        began = time.process_time()
        kind, graphs = make()
        if not graphs:
            continue
        found = compared(kind, *graphs)
        print(
            f"{name}: {found.points} of {len(graphs[0].special)} special points alike to {found.values:.1e} "
            f"(multipliers {found.multipliers:.1e}), {len(found.sentences)} differences; {time.process_time() - began:.0f} s",
            flush=True,
        )
        for sentence in found.sentences:
            print(f"  {sentence}", flush=True)


if __name__ == "__main__":
    main()
