"""Tolerances of flows: simulation, recognition, Newton's method, ends of branches."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass, fields

from contvines.shared.near_names import did_you_mean


@dataclass(frozen=True)
class FlowSettings:
    """Tolerances of a flow; those of continuation are :class:`contvines.Settings`. Sizes are those of a motion, lengths those over which f bends.

    Attributes
    ----------
    relative, absolute : float
        Simulation: errors of a step, relative to the state, and to the size of a motion.
    rough_relative, rough_absolute : float
        Simulation: the same of transients and of many starts.
    exact_relative, exact_absolute : float
        Simulation: the same of simulations with which cycles are compared.
    spread : float
        Simulation: largest ratio of two growths in one simulation of multipliers.
    far, endless : float
        Simulation: a motion has escaped so many sizes of the box of starts away, or so many times where it began and the length over which f bends.
    beside : float
        Starts: distance from an equilibrium, in lengths, at which a motion begins in its place; of copies of a motion, in sizes of the box.
    recurs, nearly : float
        Recognition: distance of two returns that are one, relative to the size of a motion; such that a more exact simulation is worth while.
    least : float
        Recognition: part of the largest range of a state below which another state counts as still.
    smallest : float
        Scales: least range of a state, relative to the largest, or to the box.
    still : float
        Recognition: size of a motion, relative to the state, that is rest.
    near : float
        Recognition: distance of a state from a motion to which it belongs, relative to its size.
    same : float
        Recognition: relative distance of points, cycles and equilibria that are one; size of a cycle that is an equilibrium.
    at_rest : float
        Ends: size, in units of the scale, of a cycle that has shrunk to an equilibrium, and distance of halves of a cycle that is one of half the period.
    halving : float
        Ends: distance of a cycle from itself half a period later, relative to its size, below which it is followed on a mesh with equal halves.
    in_phase : float
        Phase: cosine of the angle between the directions of motion of two cycles, in the mean over the period, above which one keeps the phase of the other.
    homoclinic, longest : float
        Ends: distance from an equilibrium relative to the size of a cycle, and period in units of the first one, at which a cycle counts as homoclinic.
    touch : float
        Ends: step of differences at an event, in sizes of the cycle.
    error : float
        Errors: largest one of a cycle between its mesh points, relative to its size.
    sensible : float
        Errors: error of the trivial multiplier up to which it tells that of the others.
    solved, rounded, diverged : float
        Newton's method: last correction, in units of the scale; correction that is rounding where it shrinks no more; one from which nothing converges.
    agree : float
        Functions: relative difference of values that must be equal (one state and many, mirror images).
    critical : float
        Hopf points: real part of an eigenvalue, relative to the largest one, that is zero.
    """

    relative: float = 1e-10
    absolute: float = 1e-12
    rough_relative: float = 1e-7
    rough_absolute: float = 1e-9
    exact_relative: float = 1e-12
    exact_absolute: float = 1e-13
    spread: float = 1e4
    far: float = 1e4
    endless: float = 1e12
    beside: float = 1e-3
    recurs: float = 1e-4
    nearly: float = 1e-2
    least: float = 1e-2
    smallest: float = 1e-3
    still: float = 1e-9
    near: float = 2e-3
    same: float = 1e-7
    at_rest: float = 1e-3
    halving: float = 0.2
    in_phase: float = 0.99
    homoclinic: float = 1e-6
    longest: float = 1e3
    touch: float = 1e-4
    error: float = 1e-6
    sensible: float = 1e-3
    solved: float = 1e-12
    rounded: float = 1e-9
    diverged: float = 1e6
    agree: float = 1e-9
    critical: float = 1e-8

    @classmethod
    def of(cls, given: FlowSettings | Mapping[str, float] | None) -> FlowSettings:
        """The settings that are given, with defaults for the others.

        Raises
        ------
        ValueError
            If there is no such setting, or a value is no positive number.
        """
        if isinstance(given, FlowSettings):
            return given
        if not isinstance(given, Mapping | None):
            raise ValueError(f"settings = {given!r} must be values by name, such as {{'longest': 1e4}}")
        known = [field.name for field in fields(cls)]
        for name, value in (given or {}).items():
            if name not in known:
                raise ValueError(f"settings: there is no {name!r} of a flow{did_you_mean(name, known)}")
            if isinstance(value, bool) or not isinstance(value, (int, float)) or not value > 0.0:
                raise ValueError(f"settings: {name} = {value!r} must be a positive number")
        return cls(**(given or {}))

    def changed(self) -> dict[str, float]:
        """Those that differ from the defaults."""
        return {name: value for name, value in asdict(self).items() if value != getattr(FlowSettings, name)}
