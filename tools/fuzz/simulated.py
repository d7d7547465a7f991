"""Compare orbits of branches with the event-driven simulation: events, multipliers, and return to stable orbits."""

from __future__ import annotations

from typing import Any

import numpy as np

from orbits.attractors import find_attractor
from orbits.flows import simulator_of
from orbits.flows.protocol import SimulationError
from orbits.simulation import replay
from orbits.simulation.replaying import monodromy
from orbits.starts.find import polish
from tools.fuzz.between import Between
from tools.fuzz.many_digits import exact
from tools.fuzz.motion import alike, apart
from tools.fuzz.tally import Tally

EACH = 3  # orbits per branch that are checked
STARTS = 3  # simulations per machine
BESIDE = 1e-6  # margin below which rounding decides whether an event happens
WILD = 1e6  # multiplier above which a simulation cannot follow an orbit for a period
DIFFERENCES = 1e-4  # largest relative difference of characteristic polynomials
EXACTLY = 1e-5  # the same, against multipliers in many digits
# ROUGHLY: the same in stretches of the parameter that are relatively narrower than STEEP, in which multipliers change fast
ROUGHLY, STEEP = (
    1e-3,
    1e-8,
)
PARAMETER = 1e-10  # largest difference of the parameter of the orbit in many digits, due to amplified rounding of phases
UNRESOLVED = 1e-12  # relative width of stretches of the parameter that floating point does not resolve
# relative width of stretches of the parameter in which a basin may be narrower than a displacement
NARROW = 1e-10
SMALLER = (1e-7, 1e-9)  # smaller displacements for finite differences
MOST = 4  # events at which a return map begins
SETTLED = 0.999  # largest modulus of multipliers of an orbit on which a simulation settles


def judge(graph: Any, tally: Tally, rng: np.random.Generator) -> None:
    """Check orbits between the points of each branch."""
    for branch in graph:
        if len(branch) < 2 or not len(branch.problem.word):
            continue
        between = Between(branch, graph.within)
        for i in rng.permutation(len(branch) - 1)[:EACH]:
            orbit = between.orbit(int(i), float(rng.uniform(0.2, 0.8)))
            if orbit is None:
                tally.count("places that cannot be solved for")
                continue
            settled = branch.stable[i] if branch.stable[i] == branch.stable[i + 1] else None
            if branch.real:
                width = _stretch(branch, int(i))
                if settled is not None and not settled and _unsaid(graph, branch, int(i)):
                    tally.count(
                        "places between points that are said to be too near for stable orbits to show"
                    )
                    settled, width = None, 0.0
                follow(orbit, branch.label, settled, tally, width)
            else:
                _refused(orbit, branch.label, tally)


def _said(label: str, orbit: Any) -> str:
    value = {
        name: orbit.parameters[name]
        for name in ("amplitude", "frequency", "forcing")
        if name in orbit.parameters
    }
    return f"{label} {orbit.spelling} k={orbit.periods} at " + ", ".join(
        f"{k} = {v:.10g}" for k, v in value.items()
    )


def _unsaid(graph: Any, branch: Any, i: int) -> bool:
    """Whether points i and i + 1 lie between special points whose notes state that stable orbits between them are not resolved."""
    places = [place for place, label in branch.marks if label in graph.special]
    before, after = ([k for k in places if k <= i], [k for k in places if k > i])
    if not before or not after:
        return False
    ends = max(before), min(after)
    labels = [{label for k, label in branch.marks if k == place} & graph.special.keys() for place in ends]
    near = np.ptp(branch.values[ends[0] : ends[1] + 1]) < UNRESOLVED * max(1.0, abs(branch.values[i]))
    return bool(near) and any(
        f"from {there}: solutions between" in graph[here].note
        for one, other in (labels, labels[::-1])
        for here in one
        for there in other
    )


def _stretch(branch: Any, i: int) -> float:
    """Relative width in the parameter of the stretch between two changes of stability that contains point i and the next one."""
    changes = np.flatnonzero(branch.stable[1:] != branch.stable[:-1])
    first = int(changes[changes < i].max(initial=-1)) + 1
    last = int(changes[changes > i].min(initial=len(branch) - 1))
    values = branch.values[first : last + 1]
    return float(np.ptp(values) / max(1.0, np.abs(values).max()))


def follow(orbit: Any, label: str, stable: bool | None, tally: Tally, width: float = np.inf) -> None:
    """Check a real orbit: the simulation has its events and multipliers, and returns to it if it is stable.

    If the orbit is stable only in a stretch of the parameter (of relative `width`) that floating point does not resolve, the simulation is
    not reliable; then multipliers in many digits decide.
    """
    growth = float(np.abs(orbit.multipliers).max(initial=0.0))
    said = _said(label, orbit)
    if orbit.margin < -BESIDE:
        tally.find("virtual", f"{said}: a margin is {orbit.margin:.1e} on a branch called real")
        return
    if orbit.margin < BESIDE or growth > WILD:
        tally.count("orbits beside a border, or too unstable to be simulated")
        return
    tally.count("orbits simulated")
    seen = replay(orbit, thorough=True, most=1)
    if not seen.matches:
        if seen.motion < 1e-5:
            tally.count("orbits whose motion is simulated, with other events")
        else:
            tally.find(
                "replay", f"{said}: {seen.message} (margin {orbit.margin:.1e}, multipliers to {growth:.1e})"
            )
        return
    if not min(seen.error, orbit.replay()) < 1e-9 * max(
        1.0, growth
    ):  # beside a border positions tell more than nodes
        tally.find("replay", f"{said}: nodes differ by {seen.error:.1e} (multipliers to {growth:.1e})")
    if len(seen.multipliers):
        moved = _compared(orbit, _without_trivial(orbit, seen.multipliers), said, tally, width)
        outermost = float(np.abs(moved).max())
        if stable is not None and abs(outermost - 1.0) > 1e-3 and (outermost < 1.0) != stable:
            tally.find(
                "stability",
                f"{said}: called {'stable' if stable else 'unstable'}, simulated multipliers {moved}",
            )
    else:
        tally.count("orbits at which the return map has a kink")
    if stable and width < UNRESOLVED:
        tally.count("stable stretches narrower than floating point resolves")
        if not (in_many_digits(orbit) or _as_narrow(orbit, width)):
            tally.find("return", f"{said}: called stable, which many digits do not confirm")
    elif stable and seen.returned is not None:
        tally.count("stable orbits simulated")
        if not seen.returned and growth < SETTLED and width < NARROW and _certainly_stable(orbit, width):
            tally.count("stable stretches with a basin narrower than a displacement")
        elif not seen.returned and growth < SETTLED:
            tally.find(
                "return",
                f"{said}: called stable, not returned to (margin {orbit.margin:.1e}, multipliers to {growth:.6f})",
            )


def _compared(orbit: Any, seen: np.ndarray, said: str, tally: Tally, width: float = np.inf) -> np.ndarray:
    """Compare multipliers with finite differences of the return map; return the reliable ones.

    If the return map is steep, and so nonlinear within a displacement, smaller displacements are used, and finally the orbit in many digits.
    """
    tally.count("multipliers against differences")
    gap = alike(orbit.multipliers, seen)
    if gap < DIFFERENCES:
        return seen
    simulator, letters = simulator_of(orbit.model, orbit.params), orbit.word.codes
    places = np.flatnonzero(letters < 2) if orbit.impacts else range(len(letters))
    for place in places[:MOST]:
        turned = orbit.rotate(int(place))
        for step in SMALLER:
            matrix = monodromy(simulator, turned.word, turned.nodes[0], step)
            if matrix is not None:
                gap = min(gap, alike(orbit.multipliers, _without_trivial(orbit, np.linalg.eigvals(matrix))))
        if gap < DIFFERENCES:
            tally.count("multipliers against smaller differences")
            return orbit.multipliers
    if in_many_digits(orbit, ROUGHLY if width < STEEP else EXACTLY):
        tally.count("multipliers against many digits")
        return orbit.multipliers
    tally.find(
        "multipliers", f"{said}: {orbit.multipliers} against {seen}, {gap:.1e} (margin {orbit.margin:.1e})"
    )
    return seen


def in_many_digits(orbit: Any, exactly: float = EXACTLY) -> bool:
    """Whether the orbit solved in many digits has the same multipliers and, to rounding, the same parameter."""
    found = exact(orbit)
    return (
        found is not None
        and abs(found.shift) < PARAMETER
        and alike(orbit.multipliers, found.multipliers) < exactly
    )


def _as_narrow(orbit: Any, width: float) -> bool:
    """Whether the orbit in many digits has the same multipliers, with a parameter that is equal to rounding and a tenth of the stretch's width.

    Multipliers change from 1 to -1 over the width, so a shift of the parameter changes them in proportion to shift over width.
    """
    found = exact(orbit)
    if found is None or abs(found.shift) > 0.1 * width:
        return False
    moved = 2.0 * max(abs(found.shift), float(np.finfo(float).eps))
    return alike(orbit.multipliers, found.multipliers) * width < max(EXACTLY * width, moved)


def _certainly_stable(orbit: Any, width: float) -> bool:
    """Whether the orbit in many digits is stable, with a parameter that differs by less than a tenth of the stretch's width."""
    found = exact(orbit)
    return (
        found is not None and abs(found.shift) < 0.1 * width and float(np.abs(found.multipliers).max()) < 1.0
    )


def _without_trivial(orbit: Any, multipliers: np.ndarray) -> np.ndarray:
    """Return multipliers without the trivial one (1) of a motion without impacts, whose position is free."""
    if orbit.impacts:
        return multipliers
    return np.delete(multipliers, int(np.argmin(np.abs(multipliers - 1.0))))


def _refused(orbit: Any, label: str, tally: Tally) -> None:
    """Check a virtual orbit: the simulation must not follow it."""
    if orbit.margin > BESIDE:
        tally.find(
            "virtual",
            f"{_said(label, orbit)}: called virtual, but all margins are positive ({orbit.margin:.1e})",
        )
        return
    if orbit.margin > -BESIDE:
        tally.count("virtual orbits beside a border")
        return
    tally.count("virtual orbits simulated")
    seen = replay(orbit)
    if seen.matches and seen.error < 1e-6:
        tally.find(
            "virtual",
            f"{_said(label, orbit)}: called virtual ({orbit.margin:.1e}), but the simulation follows it",
        )


def settle(draw: Any, tally: Tally, rng: np.random.Generator) -> None:
    """Check that motions on which simulations settle solve the equations of their words, with the simulated multipliers."""
    drawn = draw.machine
    for _ in range(STARTS):
        parameters = {**draw.parameters, draw.options["over"]: float(rng.uniform(*draw.options["within"]))}
        start = drawn.random_start(drawn.vector(parameters), rng)
        tally.count("starts simulated")
        try:
            found = find_attractor(drawn, start, max_period=4, patience=1, **parameters)
        except SimulationError as error:
            tally.find("exception", f"find_attractor({start}, {parameters}): {error}")
            continue
        if found.word is None or not len(found.word):
            tally.count(f"attractors: {found.kind}")
            continue
        tally.count("attractors: with a word")
        claimed = found.orbit
        said = f"attractor {claimed.spelling} k={claimed.periods} at {parameters}"
        solved = polish(claimed)
        if solved is None:
            tally.find("attractor", f"{said}: does not solve its word")
            continue
        outermost = float(np.abs(solved.multipliers).max(initial=0.0))
        if outermost > SETTLED:
            tally.count("attractors that have hardly settled")
            continue
        if not (solved.real and solved.stable):
            tally.find("attractor", f"{said}: margin {solved.margin:.1e}, multipliers {solved.multipliers}")
        gap = apart(solved, claimed, images=False)
        if not gap < 1e-7:
            tally.find("attractor", f"{said}: solved for it differs by {gap:.1e}")
        simulated = replay(claimed, thorough=True).multipliers
        if len(simulated) and solved.margin > BESIDE:
            _compared(solved, _without_trivial(solved, simulated), said, tally)
