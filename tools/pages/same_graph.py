"""Compare graphs of built-in machines with graphs of the same machines declared in machine files.

`python -m tools.pages.same_graph [friction] [friction_low] [frequency]` computes the diagrams of these example studies with
both and compares them: branches by word, periods and ends; special points by kind, value, reality and multipliers
(except at borders, where multipliers depend on the side); and the branches that meet at each point.

`python -m tools.pages.same_graph drawn absorber 50 SALT` does this with random machines of :mod:`tools.fuzz.drawing`.
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
EXACT = "exact"  # the excitation in the machine file
SAME = 1e-10  # largest difference of values of one special point
ENDS = 1e-9  # largest difference of ends of branches; the two graphs may locate a border from different sides


class Differences(NamedTuple):
    """Number of special points in both graphs, the largest differences of their values and multipliers, and texts on other differences."""

    points: int
    values: float
    multipliers: float
    sentences: list[str]


def both(name: str, **changed: Any) -> tuple[str, list[Any]]:
    """Return the machine's name and the two graphs of an example study: by the built-in machine and by the machine file."""
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
    """Return the two graphs of a random machine, without virtual branches; empty if the machine file cannot represent it, or a graph has more than `most` branches."""
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
    """Compare the graph of a built-in machine with that of its machine file."""
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
    """Return label -> label of the item in the other graph with the same key, and with numbers that differ by at most `near`; add unmatched items to `wrong`."""
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
