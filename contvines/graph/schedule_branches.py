"""Leaving: what to trace next from a special point."""

from __future__ import annotations

import copy
from collections.abc import Callable, Mapping
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..bifurcation.kinds import BORDERS
from ..bifurcation.located import Role
from ..bifurcation.location_error import rounding_of_parameter
from ..bifurcation.multiplier_counts import counts
from ..bifurcation.normal_forms.along_branch import criticality, crossing_speed, fold_coefficient
from ..bifurcation.normal_forms.criticality import cubic_form
from ..bifurcation.switching import Departure, departures
from ..branches.branch import Branch
from ..branches.special_point import TRANSCRITICAL, SpecialPoint
from ..continuation.engine import Engine, Solved
from ..interrupts import OPEN
from ..journal import NullJournal
from ..problems.abilities import Adaptive, Onward
from ..problems.protocol import Embedding, Problem, Seed
from ..problems.registry import UnknownFactory, rebuild
from .graph import Graph
from .run import Origin, Pending, Run

DERIVATIVES = 50  # unknowns up to which coefficients come from derivatives of the equations, not from the branch that leaves
WHOLE = 1.0  # amplitude, in units of the scales, of cycles as large as these
SLANTED = 0.1  # change of the parameter, in its unit and per amplitude, of a branch that goes through a point without turning there

FAMILY = (
    "the solutions that leave here are a continuous family, moved into one another by a continuous symmetry; "
    "give the problem conditions= that pick one of them"
)
VERTICAL = "the branch that leaves here stands upright: the parameter does not change along it"
SWITCHING, CROSSING = "the search for branches that leave here", "the search for solutions beyond the border"
BESIDE_HOMOCLINIC = "the branch that leaves here is not followed: within {narrowest:.1e} of {orbit}, a homoclinic orbit, an atlas follows none"
DEEPER = "the solutions found beyond are not followed: depth = {depth}"


def leave(run: Run, point: SpecialPoint, branch: Branch, depth: int) -> None:
    """Queue the branches that leave a special point, as far as the depth allows."""
    leaves = run.kind(point.kind).leaves
    if point.kind in BORDERS:
        _cross(run, point, branch, depth)
    elif point.met_from is not None and point.branch == branch.label and _from_side(run, point):
        run.attempt(point.label, SWITCHING, partial(_root, run, point, branch, depth), None)
    elif leaves in ("branch", "doubled"):
        run.attempt(point.label, SWITCHING, partial(_switch, run, point, branch, depth), None)
    elif leaves == "cycles":
        run.attempt(point.label, SWITCHING, partial(_cycles, run, point, branch, depth), None)


def why_nothing_leaves(graph: Graph, label: str) -> str:
    """A sentence on a special point from which no new branch leaves."""
    point = graph.special[label]
    known = [
        end for s in graph.switches if s.point == label for end in (s.source, s.target) if end != point.branch
    ]
    kind = graph.kind(point.kind)
    if not (kind.leaves or known):
        return kind.nothing or f"nothing is looked for that leaves a point of kind {point.kind}"
    if kind.nothing and not known:
        return kind.nothing
    if known:
        return "the graph has the branches that leave here already: " + ", ".join(dict.fromkeys(known))
    return "; ".join(point.remarks) or "no branch that leaves here was found"


def _from_side(run: Run, point: SpecialPoint) -> bool:
    event = run.events.get(point.label)
    return event is None or event.role is Role.MEETING


def _solved(run: Run, engine: Engine, point: SpecialPoint) -> Solved:
    row = np.zeros(engine.row_size)
    return Solved(point.u, point.value, point.tangent, row, 0.0, point.residual, point.location_error)


# ------------------------------------------------------------------ bifurcations


def _switch(run: Run, point: SpecialPoint, branch: Branch, depth: int) -> None:
    problem = point.attached
    engine, detector = run.engine(problem)
    here = _solved(run, engine, point)
    spectrum = engine.spectrum(_row(run, engine, point))
    generic = run.kind(point.kind).leaves == "branch"
    inside = (
        any(
            test.kind == point.kind and _is_image(engine, test.part(point.u[None, :], [point.value]))
            for test in detector.symmetries
        )
        and problem.flip_kind != point.kind
    )
    if generic or inside:
        name, critical = "plus", 1.0 + 0.0j
        children = [Embedding(problem, point.u, point.tangent, point.kind)]
    else:
        name, critical = "minus", -1.0 + 0.0j
        children = list(problem.offspring(point.kind, point.u, point.value, point.tangent, critical))
    if not children:
        run.remark(point.label, run.kind(point.kind).without)
        return
    k = _which(run, engine, point, name, spectrum)
    speed = crossing_speed(engine, here, name, k) if engine.m else None
    point.mirror = point.kind == "symmetry-breaking"
    for child in children:
        target, _ = run.engine(child.problem)
        search = partial(
            departures,
            target,
            np.asarray(child.u, dtype=float),
            point.value,
            target.unit(np.asarray(child.tangent, dtype=float)),
            one_sided=not generic,
            most=_critical(engine, spectrum, critical),
            exchanged=None if name == "plus" else _exchange(target, spectrum, point, speed),
        )
        found = search(run.settings.amplitude)
        if name == "minus":
            found = _told_apart(target, point, run.settings.amplitude, found, search, run.settings.max_step)
        if not found:
            run.remark(point.label, "no branch that leaves here was found")
        for departure in found:
            unit = run.unit(point.value)
            transcritical = abs(departure.slope) > SLANTED * unit * departure.amplitude
            rise, size = abs(point.tangent[-1]), engine.amplitude(point.tangent)
            steep = generic and transcritical and rise <= SLANTED * unit * size
            bend = fold_coefficient(engine, here) if steep else None
            turns = rise <= abs(bend or 0.0) * departure.amplitude * size
            if departure.upright(unit, run.settings.near):
                run.remark(point.label, VERTICAL)
            elif bend is not None and turns:  # a pitchfork: the known branch is the one that bends
                along = crossing_speed(engine, departure.origin, name, k) if engine.m else None
                if point.criticality is None:
                    point.criticality, point.coefficient = criticality(bend, along, flip=False)
            elif transcritical:
                run.remark(point.label, TRANSCRITICAL)
            elif point.criticality is None:
                _classify(
                    point, departure.curvature / target.amplitude(departure.direction) ** 2, speed, name
                )
            if departure.family:
                run.remark(point.label, FAMILY)
            else:
                _follow(run, departure, point, branch, depth)


def _classify(point: SpecialPoint, curvature: float, speed: float | None, name: str) -> None:
    """Criticality and coefficient from the curvature of the branch that leaves; of cycles on a mesh from the form of the return map.

    Amplitudes of unknowns that differ much in size say less.
    """
    problem = point.attached
    point.criticality, rough = criticality(curvature, speed, flip=name == "minus")
    exact = problem.normal_form(point.kind, point.u, point.value) if isinstance(problem, Adaptive) else None
    if exact is not None:
        rough = exact[0]
        point.criticality = "supercritical" if (rough > 0.0) == (name == "minus") else "subcritical"
    exactly = partial(_cubic, problem, point.u, point.value, name, rough)
    point.coefficient = rough if point.criticality is None else exactly


def _follow(run: Run, departure: Departure, point: SpecialPoint, branch: Branch, depth: int) -> None:
    """Queue a branch that leaves a special point, as far as the depth allows."""
    if depth + 1 > run.depth:
        return
    if (orbit := _beside_homoclinic(run, point, branch)) is not None:
        run.remark(point.label, BESIDE_HOMOCLINIC.format(narrowest=run.narrowest, orbit=orbit))
        return
    origin = departure.origin
    run.queue.append(
        Pending(
            departure.problem,
            origin.u,
            origin.p,
            kind=Origin.SWITCH,
            depth=depth + 1,
            source=branch.label,
            point=point.label,
            note="mirror image not traced" if point.mirror else "",
            origin=origin._replace(correction=point.location_error),
            ahead=departure.ahead,
            back=departure.back,
            first_step=min(run.settings.first_step, departure.amplitude),
        )
    )


def _beside_homoclinic(run: Run, point: SpecialPoint, branch: Branch) -> str | None:
    """Label of a homoclinic orbit at the end of a branch, next to which a special point lies; None if there is none.

    Beside the orbit of a saddle-focus folds and period doublings accumulate on the branch, and on each branch that leaves it there, within an
    interval of the parameter as narrow (P. Glendinning and C. Sparrow, J. Stat. Phys. 35 (1984) 645).
    """
    ends = [run.graph.special[label] for _, label in branch.marks]
    near = [e for e in ends if e.kind == "homoclinic" and abs(e.value - point.value) < run.narrowest]
    return near[0].label if near else None


def _cycles(run: Run, point: SpecialPoint, branch: Branch, depth: int) -> None:
    """The cycles that are born at a Hopf point, of problems that have cycles."""
    if depth + 1 > run.depth:
        return
    for child in point.attached.offspring("hopf", point.u, point.value, point.tangent, 1j):
        target, _ = run.engine(child.problem)
        direction = target.unit(np.asarray(child.tangent, dtype=float))
        start, nothing = np.asarray(child.u, dtype=float), np.zeros(target.n + 1)

        def search(
            amplitude: float,
            target: Engine = target,
            start: np.ndarray = start,
            nothing: np.ndarray = nothing,
            direction: np.ndarray = direction,
        ) -> list[Departure]:
            return departures(target, start, point.value, nothing, amplitude, True, [direction])

        amplitude = run.settings.amplitude
        found = _told_apart(target, point, amplitude, search(amplitude), search, WHOLE)
        if not found:
            run.remark(point.label, "no cycle that leaves here was found")
        for departure in found:
            if departure.upright(run.unit(point.value), run.settings.near):
                run.remark(point.label, VERTICAL)
            _follow(run, departure, point, branch, depth)


def _exchange(
    target: Engine, spectrum: NDArray[np.complex128], at: SpecialPoint, speed: float | None
) -> Callable[[Solved], bool] | None:
    """Whether a solution of the branch that leaves where a multiplier passes -1 at a speed is stable where the known one is not, and unstable where it is.

    As the parity of the number of multipliers past +1 tells, of solutions further from the point than its stated error: others do not tell on which
    side of it they are. None where it is not known at which speed.
    """
    if speed is None or not np.isfinite(speed) or target.problem.spectrum != "map":
        return None
    real = spectrum[spectrum.imag == 0.0].real
    others = int((np.abs(np.delete(real, np.abs(real + 1.0).argmin())) > 1.0).sum()) if len(real) else 0

    def exchanged(point: Solved) -> bool:
        if not _apart(target, at, point):
            return True
        past = int(counts(target, point.row)[0])
        return (past - others - int(speed * (point.p - at.value) < 0.0)) % 2 == 0

    return exchanged


def _apart(target: Engine, at: SpecialPoint, point: Solved) -> bool:
    """Whether the parameter of a solution beside a special point differs from the point's by more than is known of both."""
    return abs(point.p - at.value) > at.location_error + rounding_of_parameter(target, point)


def _told_apart(
    target: Engine,
    at: SpecialPoint,
    amplitude: float,
    found: list[Departure],
    search: Callable[[float], list[Departure]],
    most: float,
) -> list[Departure]:
    """The branches that leave, from first points so far away, up to `most`, that their parameter tells on which side of the special point they are.

    Nearer ones neither tell whether the branch turns nor whether it is stable. Those found first where none does, as of upright branches.
    """
    further, way = found, amplitude
    while further and way < most:
        if all(_apart(target, at, departure.ahead) for departure in further):
            return further
        way *= 2.0
        further = search(way)
    return found


def _critical(engine: Engine, spectrum: NDArray[np.complex128], critical: complex) -> int | None:
    """How many multipliers are critical, and so how many null vectors there may be; None where the multipliers do not tell.

    Of cycles on a mesh at least the one that was located, although beside a homoclinic orbit, where multipliers change by thousands over the
    last digits of the parameter, it misses its place by more than others that are critical together are apart.
    """
    if engine.problem.spectrum != "map":
        return None
    found = int((np.abs(spectrum - critical) < engine.settings.together).sum())
    return found or (None if engine.adaptive is None else 1)


def _cubic(problem: Problem, u: np.ndarray, p: float, name: str, rough: float | None) -> float | None:
    """The coefficient from derivatives of the equations, where these can be obtained; else the one of the branch that leaves."""
    if isinstance(problem, Adaptive) or len(u) > DERIVATIVES:
        return rough
    with OPEN:
        exact = cubic_form(problem, u, p, flip=name == "minus")
    return rough if exact is None else exact


def _is_image(engine: Engine, part: np.ndarray) -> bool:
    """Whether a solution is its own image: the part that the symmetry changes is rounding."""
    return bool(np.abs(part).max() <= engine.settings.symmetric)


def _row(run: Run, engine: Engine, point: SpecialPoint) -> np.ndarray:
    event = run.events.get(point.label)
    if event is not None:  # else the graph was loaded
        return event.point.row
    border = engine.weights * point.tangent
    solved = engine.polish(
        point.u, point.value, border, float(border @ engine.join(point.u, point.value)), point.tangent
    )
    return np.zeros(engine.row_size) if solved is None else solved.row


def _which(run: Run, engine: Engine, point: SpecialPoint, name: str, spectrum: NDArray[np.complex128]) -> int:
    """Rank of the critical multiplier among those of its sort."""
    event = run.events.get(point.label)
    if event is not None and event.index > 0:
        return event.index
    real = np.sort(spectrum[spectrum.imag == 0.0].real * (-1.0 if name == "minus" else 1.0))[::-1]
    aim = 0.0 if engine.problem.spectrum == "flow" else 1.0
    return int(np.argmin(np.abs(real - aim))) + 1 if len(real) else 1


def _root(run: Run, point: SpecialPoint, branch: Branch, depth: int) -> None:
    """A side branch has come back to the more symmetric solutions before they were known."""
    if depth + 1 > run.depth:
        return
    engine, detector = run.engine(point.attached)
    event = run.events.get(point.label)
    if event is None:  # of a graph that was loaded
        met = [
            t
            for t in detector.symmetries
            if t.kind == point.kind and _is_image(engine, t.part(point.u[None, :], [point.value]))
        ]
        if not met:
            run.remark(point.label, "the problem has no symmetry that this point has")
            return
    else:
        met = [detector.symmetries[event.index]]
    symmetry = met[0].symmetry
    if symmetry.root is not None:
        problem, u = symmetry.root(point.u)
        # it may be a shorter solution's still: asked here, as singular equations, once solved, repeat nothing exactly
        problem, u = problem.root(u, point.value) or (problem, u)
        run.queue.append(
            Pending(
                problem,
                np.asarray(u, dtype=float),
                point.value,
                kind=Origin.ROOT,
                depth=depth + 1,
                source=branch.label,
                point=point.label,
            )
        )
        return
    # in the same problem: both ways from a point on the other branch, through the special point
    engine, _ = run.engine(point.attached)
    for departure in departures(
        engine, point.u, point.value, point.tangent, run.settings.amplitude, one_sided=False
    ):
        start = departure.ahead
        if not engine.lower <= start.p <= engine.upper and departure.back is not None:
            start = departure.back
        run.queue.append(
            Pending(
                departure.problem,
                start.u,
                start.p,
                start.tangent,
                kind=Origin.ROOT,
                depth=depth + 1,
                source=branch.label,
                point=point.label,
            )
        )


# ------------------------------------------------------------------ borders


def _cross(run: Run, point: SpecialPoint, branch: Branch, depth: int) -> None:
    """At a border: the solutions on the other side, and with ``virtual`` the rest of the branch itself."""
    leaving = point
    if point.index == 0:
        leaving = copy.copy(point)  # `dataclasses.replace` would ask for what is worked out later
        leaving.tangent = -point.tangent
    outward = leaving.tangent
    if branch.real:
        seeds = _seeds(run, leaving, depth < run.depth)
        if not seeds:
            tell_dead_end(run, leaving)
        elif all(_cost(seed) + depth > run.depth for seed in seeds):
            run.remark(point.label, DEEPER.format(depth=run.depth))
        for seed in seeds:
            if depth + _cost(seed) > run.depth:
                continue
            run.queue.append(
                Pending(
                    seed.problem,
                    np.asarray(seed.u, dtype=float),
                    float(seed.p),
                    None if seed.tangent is None else np.asarray(seed.tangent, dtype=float),
                    kind=Origin.BORDER,
                    depth=depth + _cost(seed),
                    source=branch.label,
                    point=point.label,
                    note=str(seed.note) or ("persistence" if seed.persistence else "nonsmooth fold"),
                )
            )
    if run.virtual:
        engine, _ = run.engine(point.attached)
        origin = engine.polish(
            point.u,
            point.value,
            engine.weights * outward,
            float(engine.weights * outward @ engine.join(point.u, point.value)),
            outward,
        )
        if origin is not None:
            origin = origin._replace(tangent=engine.unit(outward))  # solved for, it may be rounding
        run.queue.append(
            Pending(
                point.attached,
                point.u,
                point.value,
                outward,
                kind=Origin.REST,
                depth=depth,
                source=branch.label,
                point=point.label,
                note="virtual" if branch.real else "real again",
                real=not branch.real,
                origin=origin,
            )
        )


def tell_dead_end(run: Run, point: SpecialPoint) -> None:
    """Say why nothing goes on at a border."""
    run.remark(point.label, run.attempt(point.label, CROSSING, partial(point.attached.dead_end, point), ""))


def _cost(seed: Seed) -> int:
    """How many switches deeper a branch beyond a border is: one that goes on in the same direction is as deep."""
    return 0 if seed.persistence else 1


def _seeds(run: Run, point: SpecialPoint, every: bool) -> list[Seed]:
    """What lies beyond a border; unless `every`, what would not be followed is left out if something else is found."""
    problem = point.attached
    onward = problem.onward if isinstance(problem, Onward) and not every else None
    key = f"{run.serial}/{'beyond' if onward is None else 'onward'}/{point.label}"
    recorded = run.journal.recall(key)
    known = _rebuilt(recorded)
    if known is not None:
        return known
    ask = onward or problem.beyond
    seeds = run.attempt(point.label, CROSSING, lambda: list(ask(point)), None)
    if seeds is None:
        return []
    if recorded is None and not isinstance(run.journal, NullJournal):
        run.journal.record(key, _recorded(seeds))
    return seeds


def _recorded(seeds: list[Seed]) -> dict[str, Any]:
    """Seeds as a journal keeps them."""
    record: dict[str, Any] = {
        "problems": [dict(seed.problem.describe()) for seed in seeds],
        "p": [float(seed.p) for seed in seeds],
        "note": [str(seed.note) for seed in seeds],
        "persistence": [bool(seed.persistence) for seed in seeds],
    }
    for i, seed in enumerate(seeds):
        record[f"u{i}"] = np.asarray(seed.u, dtype=float)
        if seed.tangent is not None:
            record[f"tangent{i}"] = np.asarray(seed.tangent, dtype=float)
    return record


def _rebuilt(record: Mapping[str, Any] | None) -> list[Seed] | None:
    """The seeds of a journal's record; None where a problem cannot be obtained from it, and is asked for again."""
    if record is None:
        return None
    seeds = []
    for i, entry in enumerate(record["problems"]):
        try:
            problem = rebuild(entry)
        except UnknownFactory:
            return None
        if problem is None:
            return None
        tangent, note = record.get(f"tangent{i}"), record["note"][i]
        persistence = bool(record["persistence"][i])
        seeds.append(Seed(problem, record[f"u{i}"], record["p"][i], tangent, "border", note, persistence))
    return seeds
