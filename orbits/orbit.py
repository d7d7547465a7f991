"""Orbit: one periodic motion with its stability and admissibility; and the distance of two orbits, independent of their words."""

from __future__ import annotations

import copy
import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any, ClassVar, Self

import numpy as np

from contvines.shared.motions import attracts, onto_circle
from contvines.shared.near_names import hinting
from contvines.shared.numbers import pairs
from orbits.cycle import Cycle
from orbits.flows.protocol import Equations
from orbits.settings import BORDERING, EVENTS
from orbits.simulation.replaying import deviation
from orbits.words import Margin, approaches_of, limits_of, margin_units, named_margins

REAL = (
    -EVENTS.zero
)  # margins between this and zero, in units of the machine's own size, count as zero: a border orbit is real
PER_PERIOD = 200  # instants per forcing period at which motions are compared
CLOSE = 0.05  # largest difference in position, in units of the machine's size, between a border orbit and an orbit that converges to it
SHRINKS = 0.5  # a distance that tends to zero shrinks at least by this factor on the way to the border
COARSE = 10  # step of instants in a first, rough comparison
INSTANTS = PER_PERIOD // 5  # instants per forcing period for motions near a border


@dataclass(frozen=True, eq=False, repr=False)
class Orbit(Cycle):
    """A periodic orbit with its residual, its multipliers (stability) and its margins (whether a machine can follow it).

    Attributes
    ----------
    model : Absorber, Coupled, Cavity or Machine
        The machine.
    word : Word
        Its events over the whole period; the empty word is a motion without events.
    periods : int
        Forcing periods after which it closes; 1 for a self-excited machine.
    nodes : float array (L, n)
        One row per event. Of a built-in machine phase and velocity after an impact (position elsewhere), of the coupled one also v and v'; of
        a declared machine the phase (of a self-excited one: the duration of the flight that follows) and the states after the event.
    params : float array (P,)
        Parameter vector, in the order of `model.parameter_names`.
    """

    marginal: ClassVar[bool] = False
    """Whether it is the orbit of a special point, at which a multiplier is on the unit circle by definition."""

    # ------------------------------------------------------------------ one look at its equations
    def system(self, symmetric: bool) -> Equations:
        """Return its equations, against the machine's default parameter, or against one that preserves the mirror symmetry."""
        model = self.model
        names = (model.default_parameter, *model.parameter_names)
        lasting = (name for name in names if not symmetric or model.has_mirror(self.params, name))
        parameter = next(lasting, names[0])
        return self.flow.equations(model, self.word, self.periods, parameter, self.params, symmetric)

    @cached_property
    def _examined(self) -> tuple[float, np.ndarray, np.ndarray]:
        """Residual, multipliers of the period, and margins."""
        half = self.symmetric and bool(self.flow.loose(self.model, self.word))
        system = self.system(half)
        residual, spectrum, margins = self._examine(system)
        rounding = (margins < 0.0) & (margins >= REAL)
        return residual, system.to_multipliers(spectrum), np.where(rounding, 0.0, margins)

    def _examine(self, system: Equations) -> tuple[float, np.ndarray, np.ndarray]:
        return examined(system, system.reduce(self.nodes), system.value(system.params))

    @property
    def residual(self) -> float:
        """Largest residual of the equations."""
        return self._examined[0]

    @property
    def multipliers(self) -> np.ndarray:
        """Multipliers of the period, complex, largest modulus first; trivial ones are left out."""
        return self._examined[1]

    @property
    def half_multipliers(self) -> np.ndarray:
        """Multipliers of the half map (half a period, then the mirror) of a symmetric orbit.

        +1 is a fold, -1 a symmetry breaking; the multipliers of the period are their squares.

        Raises
        ------
        ValueError
            If the orbit is not symmetric.
        """
        if not self.symmetric:
            raise ValueError(f"the orbit {self.word.text!r} is not symmetric, so it has no half map")
        return self._examine(self.system(symmetric=True))[1]

    def with_multipliers(self, multipliers: np.ndarray) -> Self:
        """Return the same orbit with given multipliers: at a border, one-sided limits along a branch.

        If an event has no duration or speed at all, derivatives of the equations themselves are roundoff.
        """
        residual, _, margins = self._examined
        found = copy.copy(self)
        vars(found)["_examined"] = (residual, limits_of(multipliers), margins)
        return found

    def critical(self, near: float) -> Self:
        """Return the orbit as that of a special point: the multiplier nearest to the unit circle, if within `near`, is moved onto it."""
        found = self.with_multipliers(onto_circle(self.multipliers, near))
        vars(found)["marginal"] = True
        return found

    @property
    def margins(self) -> list[Margin]:
        """Margins, none negative for a real orbit; in the units of the nodes."""
        margins = self._examined[2]  # only those of half the motion, if it is symmetric and can be shifted
        units = margin_units(self.word, self.model.natural_units(self.params))
        return named_margins(self.word, margins * units[: margins.size])

    @property
    def relative_margins(self) -> list[Margin]:
        """Margins in units of the machine's own size."""
        return named_margins(self.word, self._examined[2])

    @property
    def approaches(self) -> np.ndarray:
        """Margins of the impacts, which are their speeds, in units of the machine's own size."""
        return approaches_of(self.word, self._examined[2])

    @property
    def margin(self) -> float:
        """The smallest margin, in units of the machine's own size."""
        return float(np.min(self._examined[2]))

    @property
    def real(self) -> bool:
        """Whether a machine can follow the orbit: no margin is negative. At a border one margin is zero, and the orbit real."""
        return self.margin >= 0.0

    @property
    def stable(self) -> bool | None:
        """Whether all multipliers lie inside the unit circle; at special points None, or False if one lies outside."""
        sizes = np.abs(self.multipliers)
        return attracts(sizes, 1.0) if self.marginal else bool((sizes < 1.0).all())

    def measures(self, *wanted: str) -> dict[str, float]:
        """Return measures by name, all of them if none is named; names: `problem().measure_names`.

        Raises
        ------
        KeyError
            If a name is unknown.
        """
        names = wanted or self.flow.measure_names(self.model)
        values = self.flow.measures(
            self.model, self.word, self.periods, self.nodes[None], self.params[None], list(names)
        )
        return {name: float(value[0]) for name, value in values.items()}

    def measure(self, name: str) -> float:
        """Return one measure of the orbit; names: `problem().measure_names`."""
        return float(self.measures(name)[name])

    # ------------------------------------------------------------------ seeing it move
    def sample(self, points: int = 400) -> dict[str, np.ndarray]:
        """Sample the motion over one period; each event appears with the states before and after it.

        Parameters
        ----------
        points : int
            Approximate number of samples; at least two per flight.

        Returns
        -------
        dict of ndarray
            Each of shape (m,). Of a built-in machine ``tau`` (dimensionless time from the first event), ``phase``, ``w``, ``w_rate``, ``v``,
            ``v_rate``, and the positions ``cavity`` (q1) and ``absorber`` (q2); of a declared one ``time``, ``phase`` and its states by
            name. ``segment`` is the index of the event before.
        """
        return self.flow.sample(self, points)

    def positions(self, instants: int) -> np.ndarray:
        """Return coordinates without jumps at `instants` equal phases of each forcing period, shape (instants * periods, c); cached."""
        tracks = vars(self).setdefault("_tracks", {})
        if instants not in tracks:
            tracks[instants] = self.flow.positions(self, instants)
        return tracks[instants]

    def repeat(self, times: int) -> Self:
        """Return the same orbit, written `times` times."""
        found = super().repeat(times)
        tracks = vars(self).get("_tracks", {})
        vars(found)["_tracks"] = {instants: np.tile(track, (times, 1)) for instants, track in tracks.items()}
        return found

    def replay(self) -> float:
        """Return the largest deviation of the event-driven simulation from the orbit over one period, in units of the machine's own size.

        Infinite if the simulation has other events.
        """
        return deviation(self, lambda: (self._examined[2], self.multipliers))

    # ------------------------------------------------------------------ towards continuation
    @hinting
    def problem(self, parameter: str | None = None, symmetric: bool | None = None):
        """Return the continuation problem of the orbit's word against `parameter`.

        Parameters
        ----------
        parameter : str, optional
            Default: `model.default_parameter`.
        symmetric : bool, optional
            Solve on half the word; by default if the orbit is symmetric, and stays so along the parameter.
        """
        from orbits.problem import OrbitProblem

        parameter = str(parameter or self.model.default_parameter)
        if not self.forced and not len(self.word) and self.word.modes:
            from orbits.flows.page.smooth import cycles_of

            return cycles_of(self).problem(parameter)
        lasting = self.symmetric and self.model.has_mirror(self.params, parameter)
        half = lasting if symmetric is None else symmetric
        return OrbitProblem(self.model, self.word, self.periods, parameter, self.params, half)

    def seed(self, problem: Any) -> tuple[np.ndarray, float]:
        """Return unknowns and parameter value of this orbit in `problem`."""
        if not self.forced and not len(self.word) and self.word.modes:
            return problem.u0, problem.p0
        return problem.reduce(self.nodes), problem.value(self.params)

    # ------------------------------------------------------------------ seeing and proving
    def prove(self, bits: int | None = None, **parameters: Any):
        """Prove in ball arithmetic that the orbit exists, is real or virtual, stable or unstable (extra `proofs`).

        Parameters
        ----------
        bits : int, optional
            First precision to try.
        **parameters
            Exact values, as decimals (``amplitude="1.0735"``) or balls (``amplitude=("0.6", "1e-6")``); by default the shortest decimals of
            the orbit's floats.

        Returns
        -------
        orbits.proofs.proof.Proof
            `real` and `stable` are True, False or None (not proved); `box` encloses the unique solution, `obstacles` lists what is not proved.

        Raises
        ------
        ValueError
            If python-flint is missing, a parameter does not exist, or the machine's flights have no closed form.
        """
        from orbits.proofs.subjects import of_orbit

        return of_orbit(self, bits, **parameters)

    def _repr_html_(self) -> str:
        from orbits.plots.portrait import page

        return page(self)

    def plot(self, **options: Any):
        """Draw phase portrait and time history; options are those of :func:`orbits.plots.portrait.portrait`."""
        from orbits.plots.portrait import portrait

        return portrait(self, **options)

    def animate(self, path: str | Path | None = None, **options: Any):
        """Show the orbit in motion, or write the animation to `path` as a gif, mp4 (by ffmpeg) or html file.

        Options are those of :func:`orbits.plots.animation.animate`.
        """
        from orbits.plots.animation import animate

        return animate(self, path, **options)

    def scene(self, points: int = 120) -> dict[str, Any]:
        """Return the orbit as plain numbers for a web page that draws it; see `orbits.plots.shown.scene`."""
        from orbits.plots.shown import scene

        return scene(self, points)

    def to_dict(self) -> dict[str, Any]:
        """Return the orbit ready for JSON: events, multipliers, margins."""
        return {
            "word": self.spelling,
            "periods": self.periods,
            "impacts": self.impacts,
            "symmetric": self.symmetric,
            **self.model.described(self.params),
            **self.flow.described(self),
            "multipliers": pairs(self.multipliers),
            "stable": self.stable,
            "margins": [{"kind": m.kind, "segment": m.segment, "value": m.value} for m in self.margins],
            "real": self.real,
            "residual": self.residual,
        }


def examined(system: Equations, u: np.ndarray, p: float) -> tuple[float, np.ndarray, np.ndarray]:
    """Return residual, multipliers of the closure map and margins of a solution; the linearisation remains in `system.scratch`."""
    count = 2 * system.n_multipliers
    row = np.empty(count + system.n_margins)
    residual = system.kernels.examine(system.data, u, p, system.scratch, row)
    return float(residual), row[:count].view(np.complex128), row[count:]


def tends(close: float, further: Callable[[], float]) -> bool:
    """Return whether an orbit converges to a border orbit as it approaches the border.

    `close` is its distance from the border orbit. `further`, called only if needed, returns the distance of the same branch's orbit further
    away from the border: an orbit that is merely similar keeps its distance.
    """
    return close < BORDERING.simultaneous or (close < CLOSE and close < SHRINKS * further())


def gap(border: Orbit, near: Orbit) -> float:
    """Return the distance of two orbits of one branch, or of a branch and its border, from fewer instants and without shifts of the phase."""
    if border.periods != near.periods or not border.forced:
        return distance(border, near)
    unit = border.model.natural_units(border.params)[0]
    differences = border.positions(INSTANTS) - near.positions(INSTANTS)
    return float(_largest(differences, _shiftable(border, near))) / unit


def distance(one: Orbit, other: Orbit, mirror: bool = False, instants: int = PER_PERIOD) -> float:
    """Return the largest difference of positions at equal phases, minimised over shifts by whole periods (and the mirror image, if `mirror`).

    In units of the machine's size. If one of them can be shifted as a whole (it hits no wall) mean positions are ignored. Self-excited motions
    have no common phase: they are compared by periods and extremes, relative to 1 + size.
    """
    if not one.forced:
        images = [one, one.mirror()] if mirror else [one]
        return min(_unlike(image, other) for image in images)
    free = _shiftable(one, other)
    unit = one.model.natural_units(one.params)[0]
    if one.periods == other.periods == 1 and not mirror:
        return float(_largest(one.positions(instants) - other.positions(instants), free)) / unit
    periods = math.lcm(one.periods, other.periods)
    first, second = (
        orbit.positions(instants)
        if orbit.periods == periods
        else np.tile(orbit.positions(instants), (periods // orbit.periods, 1))
        for orbit in (one, other)
    )
    images = [first]
    if mirror:
        images.append(2.0 * float(one.model.middle(one.params)) - np.roll(first, -instants // 2, axis=0))
    best = np.inf
    turned = (instants * np.arange(one.periods)[:, None] + np.arange(0, len(first), COARSE)) % len(first)
    for image in images:
        rough = _largest(image[turned] - second[::COARSE], free)
        for shift in np.argsort(rough, kind="stable").tolist() if len(rough) > 1 else (0,):
            if rough[shift] >= best:
                break
            shifted = np.roll(image, -instants * shift, axis=0) if shift else image
            best = min(best, float(_largest(shifted - second, free)))
    return best / unit


def _shiftable(one: Orbit, other: Orbit) -> np.ndarray:
    """Return which positions can be shifted as a whole."""
    loose = {*one.flow.loose(one.model, one.word), *other.flow.loose(other.model, other.word)}
    return np.array([entry in loose for entry in one.flow.position_entries(one.model)])


def _largest(gap: np.ndarray, free: np.ndarray) -> np.ndarray:
    """Return the largest entry of a difference (..., instants, c); for free positions half the range."""
    if not free.any():
        return np.abs(gap).max(axis=(-2, -1))
    return np.where(free, 0.5 * np.ptp(gap, axis=-2), np.abs(gap).max(axis=-2)).max(axis=-1)


def _unlike(one: Orbit, other: Orbit) -> float:
    """Return the largest difference of periods and extremes (for free positions: ranges), relative to 1 + size."""
    names = [f"{side}_{state}" for state in one.model.node_names[1:] for side in ("max", "min")]
    free = {
        one.model.node_names[entry]
        for entry in (*one.flow.loose(one.model, one.word), *other.flow.loose(other.model, other.word))
    }
    rows = []
    for orbit in (one, other):
        found = orbit.measures(*names, "period")
        for state in free:
            found[f"max_{state}"] -= found[f"min_{state}"]
            found[f"min_{state}"] = 0.0
        rows.append(np.array(list(found.values())))
    a, b = rows
    return float(np.abs(a - b).max() / (1.0 + np.abs(a).max()))
