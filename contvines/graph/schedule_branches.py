"""Schedule branches: compute the first points of the branches that leave a special point, and queue them."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

import numpy as np
from numpy.typing import NDArray

from ..bifurcation.kinds import BORDERS
from ..bifurcation.locate import Role
from ..bifurcation.location_error import rounding_of_parameter
from ..bifurcation.normal_forms.criticality import criticality, crossing_speed, cubic_form, fold_coefficient
from ..bifurcation.scan import SymmetryTest, counts
from ..bifurcation.switching import Departure, departures
from ..branches import Branch
from ..branches.special_point import TRANSCRITICAL, SpecialPoint
from ..continuation.engine import Engine, Solved
from ..continuation.settings import Settings
from ..long_work import OPEN
from ..problems.abilities import Adaptive
from ..problems.protocol import Embedding, Problem
from . import Graph
from .match_borders import cross
from .run import Origin, Pending, Run

DERIVATIVES = 50  # up to this number of unknowns coefficients are computed from derivatives, not from the leaving branch
WHOLE = 1.0  # largest amplitude of first cycles beside a Hopf point, in units of the scales
SLANTED = 0.1  # slope of the parameter per amplitude, in its unit, from which a branch crosses a point without turning
HALVINGS = 4  # number of amplitudes that are tried for a cycle beside a Hopf point

FAMILY = (
    "the solutions that leave here are a continuous family, mapped to one another by a continuous symmetry; "
    "give the problem conditions= that select one of them"
)
VERTICAL = "the branch that leaves here stands upright: the parameter does not change along it"
SWITCHING = "the search for branches that leave here"
BESIDE_HOMOCLINIC = "the branch that leaves here is not followed: within {narrowest:.1e} of {orbit}, a homoclinic orbit, an atlas follows none"

Search = Callable[[float], list[Departure]]
"""Function: amplitude of the first points -> branches that leave."""


def leave(run: Run, point: SpecialPoint, branch: Branch, depth: int) -> None:
    """Queue the branches that leave a special point, as far as the run's depth allows.

    Parameters
    ----------
    run : Run
    point : SpecialPoint
    branch : Branch
        Branch on which the point lies.
    depth : int
        Number of switches used for this branch.
    """
    if point.kind in BORDERS:
        cross(run, point, branch, depth)
        return
    leaves, leaving = run.kind(point.kind).leaves, _Leaving(run, point, branch, depth)
    event = run.events.get(point.label)
    joined = point.met_from is not None and point.branch == branch.label
    if joined and (event is None or event.role is Role.MEETING):
        run.attempt(point.label, SWITCHING, leaving.root, None)
    elif leaves in ("branch", "doubled"):
        run.attempt(point.label, SWITCHING, leaving.switch, None)
    elif leaves == "cycles":
        run.attempt(point.label, SWITCHING, leaving.cycles, None)


def why_nothing_leaves(graph: Graph, label: str) -> str:
    """Return a sentence why no new branch leaves a special point."""
    point = graph.special[label]
    connected = [
        end for s in graph.switches if s.point == label for end in (s.source, s.target) if end != point.branch
    ]
    kind = graph.kind(point.kind)
    if not (kind.leaves or connected):
        return kind.nothing or f"no branch is sought that leaves a point of kind {point.kind}"
    if kind.nothing and not connected:
        return kind.nothing
    if connected:
        return "the graph has the branches that leave here already: " + ", ".join(dict.fromkeys(connected))
    return "; ".join(point.remarks) or "no branch that leaves here was found"


class _Leaving:
    """A special point whose leaving branches are computed, its branch, and the number of switches used for it; see :func:`leave`."""

    def __init__(self, run: Run, point: SpecialPoint, branch: Branch, depth: int) -> None:
        self.run, self.point, self.branch, self.depth = run, point, branch, depth
        self.detector = run.detector(point.attached)
        self.engine, self.problem = self.detector.engine, point.attached
        self.event = run.events.get(point.label)  # None in a loaded graph

    def switch(self) -> None:
        """Queue the branches that leave a branch point, period doubling or symmetry breaking, and classify the point.

        Their solutions belong to the same problem, or to a larger one at a period doubling or symmetry breaking.
        """
        run, point, engine, problem = self.run, self.point, self.engine, self.problem
        generic = run.kind(point.kind).leaves == "branch"
        if generic or (problem.flip_kind != point.kind and any(map(self._mirrors, self.detector.symmetries))):
            name, critical = "plus", 1.0 + 0.0j
            children = [Embedding(problem, point.u, point.tangent, point.kind)]
        else:
            name, critical = "minus", -1.0 + 0.0j
            children = list(problem.offspring(point.kind, point.u, point.value, point.tangent, critical))
        if not children:
            run.remark(point.label, run.kind(point.kind).without)
            return
        solved = self._solved()
        spectrum = engine.spectrum(solved.row)
        k = self._rank(name, spectrum)
        speed = crossing_speed(engine, solved, name, k) if engine.m else None
        point.mirror = point.kind == "symmetry-breaking"
        for child in children:
            target = run.engine(child.problem)
            search = partial(
                departures,
                target,
                np.asarray(child.u, dtype=float),
                point.value,
                target.unit(np.asarray(child.tangent, dtype=float)),
                one_sided=not generic,
                most=_critical(engine, spectrum, critical),
                exchanged=None if name == "plus" else self._exchange_test(target, spectrum, speed),
            )
            most = run.settings.max_step if name == "minus" else 0.0
            found = self._distinct(target, search, most)
            if not found:
                run.remark(point.label, "no branch that leaves here was found")
            for departure in found:
                unit = run.unit(point.value)
                transcritical = abs(departure.slope) > SLANTED * unit * departure.amplitude
                rise, size = abs(point.tangent[-1]), engine.amplitude(point.tangent)
                steep = generic and transcritical and rise <= SLANTED * unit * size
                bend = fold_coefficient(engine, solved) if steep else None
                turns = rise <= abs(bend or 0.0) * departure.amplitude * size
                if departure.upright(unit, run.settings.near):
                    run.remark(point.label, VERTICAL)
                elif bend is not None and turns:  # a pitchfork whose bending branch is the known one
                    along = crossing_speed(engine, departure.origin, name, k) if engine.m else None
                    if point.criticality is None:
                        point.criticality, point.coefficient = criticality(bend, along, flip=False)
                elif transcritical:
                    run.remark(point.label, TRANSCRITICAL)
                elif point.criticality is None:
                    curvature = departure.curvature / target.amplitude(departure.direction) ** 2
                    self._classify(curvature, speed, flip=name == "minus")
                if departure.family:
                    run.remark(point.label, FAMILY)
                else:
                    self._follow(departure)

    def cycles(self) -> None:
        """Queue the cycles that are born at a Hopf point, for problems that have cycles."""
        run, point = self.run, self.point
        if self.depth + 1 > run.depth:
            return
        for child in self.problem.offspring("hopf", point.u, point.value, point.tangent, 1j):
            target = run.engine(child.problem)
            found = self._distinct(target, partial(_cycles, target, child, point.value), WHOLE)
            if not found:
                run.remark(point.label, "no cycle that leaves here was found")
            for departure in found:
                if departure.upright(run.unit(point.value), run.settings.near):
                    run.remark(point.label, VERTICAL)
                self._follow(departure)

    def root(self) -> None:
        """Queue the branch of more symmetric solutions that a side branch has met before they were known."""
        run, point, engine = self.run, self.point, self.engine
        if self.depth + 1 > run.depth:
            return
        if self.event is not None:
            broken = [self.detector.symmetries[self.event.index]]
        else:
            broken = [test for test in self.detector.symmetries if self._mirrors(test)]
        if not broken:
            run.remark(point.label, "the problem has no symmetry that this point has")
            return
        symmetry = broken[0].symmetry
        if symmetry.root is not None:
            problem, u = symmetry.root(point.u)
            # it may repeat a shorter solution; tested here, as the solved point of singular equations no longer repeats it exactly
            problem, u = problem.root(u, point.value) or (problem, u)
            self._queue(Pending(problem, np.asarray(u, dtype=float), point.value, kind=Origin.ROOT))
            return
        # in the same problem: start from a point on the other branch, and follow it in both directions
        amplitude = run.settings.amplitude
        for departure in departures(engine, point.u, point.value, point.tangent, amplitude, one_sided=False):
            start = departure.ahead
            if not engine.lower <= start.p <= engine.upper and departure.back is not None:
                start = departure.back
            self._queue(Pending(departure.problem, start.u, start.p, start.tangent, Origin.ROOT))

    def _queue(self, pending: Pending) -> None:
        """Queue a branch that is one switch deeper."""
        pending.depth, pending.source, pending.point = self.depth + 1, self.branch.label, self.point.label
        self.run.queue.append(pending)

    def _follow(self, departure: Departure) -> None:
        """Queue a branch that leaves, if the depth allows, and no homoclinic orbit is nearer than `Run.narrowest`.

        Folds and period doublings accumulate on a branch near the homoclinic orbit of a saddle-focus, and likewise on each branch that leaves it
        there (P. Glendinning and C. Sparrow, J. Stat. Phys. 35 (1984) 645).
        """
        run, point = self.run, self.point
        if self.depth + 1 > run.depth:
            return
        for end in (run.graph.special[label] for _, label in self.branch.marks):
            if end.kind == "homoclinic" and abs(end.value - point.value) < run.narrowest:
                run.remark(point.label, BESIDE_HOMOCLINIC.format(narrowest=run.narrowest, orbit=end.label))
                return
        origin = departure.origin
        self._queue(
            Pending(
                departure.problem,
                origin.u,
                origin.p,
                kind=Origin.SWITCH,
                note="mirror image not traced" if point.mirror else "",
                origin=origin._replace(correction=point.location_error),
                ahead=departure.ahead,
                back=departure.back,
                first_step=min(run.settings.first_step, departure.amplitude),
            )
        )

    def _classify(self, curvature: float, speed: float | None, flip: bool) -> None:
        """Set criticality and coefficient from the curvature of the branch that leaves; for cycles on a mesh from the normal form of the return map.

        The latter is more accurate if the unknowns have very different sizes.
        """
        point, problem = self.point, self.problem
        point.criticality, rough = criticality(curvature, speed, flip)
        if isinstance(problem, Adaptive):
            exact = problem.normal_form(point.kind, point.u, point.value)
            if exact is not None:
                rough = exact[0]
                point.criticality = "supercritical" if (rough > 0.0) == flip else "subcritical"
        exactly = partial(_cubic, problem, point.u, point.value, flip, rough)
        point.coefficient = rough if point.criticality is None else exactly

    def _exchange_test(
        self, target: Engine, spectrum: NDArray[np.complex128], speed: float | None
    ) -> Callable[[Solved], bool] | None:
        """Return a test for the exchange of stability at a multiplier -1: first point of the leaving branch -> whether its stability agrees.

        The leaving branch is stable on the side where the known branch is unstable, and conversely. The test compares the parity of the number of
        multipliers past +1. Points within the error of the special point pass, as their side is unknown.

        Parameters
        ----------
        target : Engine
            Engine of the leaving branch.
        spectrum : ndarray of complex
            Multipliers at the special point.
        speed : float or None
            Crossing speed of the critical multiplier; if unknown, the result is None.
        """
        if speed is None or not np.isfinite(speed) or target.problem.spectrum != "map":
            return None
        real = spectrum[spectrum.imag == 0.0].real
        others = int((np.abs(np.delete(real, np.abs(real + 1.0).argmin())) > 1.0).sum()) if len(real) else 0

        def exchanged(point: Solved) -> bool:
            if not self._beyond_errors(target, point):
                return True
            outside = int(counts(target, point.row)[0])
            return (outside - others - int(speed * (point.p - self.point.value) < 0.0)) % 2 == 0

        return exchanged

    def _beyond_errors(self, target: Engine, solved: Solved) -> bool:
        """Whether the parameter of a solution beside the special point differs from that of the point by more than the errors of both."""
        error = self.point.location_error + rounding_of_parameter(target, solved)
        return abs(solved.p - self.point.value) > error

    def _distinct(self, target: Engine, search: Search, most: float) -> list[Departure]:
        """Return the branches that leave, with first points whose parameter differs from that of the special point by more than the errors.

        Nearer points do not show on which side of the special point the branch lies. The amplitude is doubled up to `most`; if no amplitude is large
        enough, as for upright branches, the branches from the first amplitude are returned.
        """
        amplitude = self.run.settings.amplitude
        found = further = search(amplitude)
        while further and amplitude < most:
            if all(self._beyond_errors(target, departure.ahead) for departure in further):
                return further
            amplitude *= 2.0
            further = search(amplitude)
        return found

    def _mirrors(self, test: SymmetryTest) -> bool:
        """Whether the special point breaks a symmetry: its kind is that of the symmetry, and the solution is its own image to rounding."""
        point = self.point
        part = test.part(point.u[None, :], [point.value])
        return test.kind == point.kind and bool(np.abs(part).max() <= self.engine.settings.symmetric)

    def _solved(self) -> Solved:
        """Return the special point as a solved point, with its row."""
        point, engine = self.point, self.engine
        if self.event is not None:
            return self.event.point
        border = engine.weights * point.tangent
        target = float(border @ engine.join(point.u, point.value))
        found = engine.polish(point.u, point.value, border, target, point.tangent)
        row = np.zeros(engine.row_size) if found is None else found.row
        return Solved(point.u, point.value, point.tangent, row, 0.0, point.residual, point.location_error)

    def _rank(self, name: str, spectrum: NDArray[np.complex128]) -> int:
        """Return the rank of the critical multiplier among those of its sort."""
        if self.event is not None and self.event.index > 0:
            return self.event.index
        real = np.sort(spectrum[spectrum.imag == 0.0].real * (-1.0 if name == "minus" else 1.0))[::-1]
        aim = 0.0 if self.problem.spectrum == "flow" else 1.0
        return int(np.argmin(np.abs(real - aim))) + 1 if len(real) else 1


def _critical(engine: Engine, spectrum: NDArray[np.complex128], critical: complex) -> int | None:
    """Return the number of critical multipliers, which limits the number of null vectors; None if it is unknown.

    For cycles on a mesh it is at least one: beside a homoclinic orbit, where multipliers change by thousands over the last digits of the
    parameter, the computed critical multiplier may be far from its value.
    """
    if engine.problem.spectrum != "map":
        return None
    found = int((np.abs(spectrum - critical) < engine.settings.together).sum())
    return found or (None if engine.adaptive is None else 1)


def _cubic(problem: Problem, u: np.ndarray, p: float, flip: bool, rough: float | None) -> float | None:
    """Return the coefficient from derivatives of the equations if possible, else `rough`, the one from the branch that leaves."""
    if isinstance(problem, Adaptive) or len(u) > DERIVATIVES:
        return rough
    with OPEN:
        exact = cubic_form(problem, u, p, flip)
    return rough if exact is None else exact


def _cycles(target: Engine, child: Embedding, p: float, amplitude: float) -> list[Departure]:
    """Return small cycles beside a Hopf point, as departures in the problem of cycles."""
    direction = target.unit(np.asarray(child.tangent, dtype=float))
    u, nothing = np.asarray(child.u, dtype=float), np.zeros(target.n + 1)
    return departures(target, u, p, nothing, amplitude, True, [direction])


def cycle_at(point: SpecialPoint) -> object:
    """Return one of the small cycles that are born at a Hopf point, as the problem's object for users.

    Raises
    ------
    ValueError
        If the problem has no cycles, or none is found.
    """
    settings, width = Settings(), 1.0 + abs(point.value)
    for child in point.attached.offspring("hopf", point.u, point.value, point.tangent, 1j):
        target = Engine(child.problem, (point.value - width, point.value + width), settings)
        for halving in range(HALVINGS):
            found = _cycles(target, child, point.value, settings.amplitude * 0.5**halving)
            if found:
                return child.problem.orbit(found[0].ahead.u, found[0].ahead.p)
    raise ValueError(
        f"{point.label}: no cycle is found there; only Hopf points of a contvines.FlowProblem have cycles"
    )
