"""Tolerances of flows: simulation, recognition, Newton's method, ends of branches."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass, fields

from contvines.shared.near_names import did_you_mean


@dataclass(frozen=True)
class FlowSettings:
    """Tolerances of a flow; those of continuation are :class:`contvines.Settings`.

    Below, the size of a motion is the range of its states, and a length is the change of a state over which f is nonlinear.

    Attributes
    ----------
    relative, absolute : float
        Simulation: error tolerances of the integrator, relative to the state and to the size of the motion.
    rough_relative, rough_absolute : float
        Simulation: the same for transients and for many starts.
    exact_relative, exact_absolute : float
        Simulation: the same for simulations that check cycles.
    spread : float
        Simulation: largest ratio of two growth factors in one simulation of multipliers.
    far, endless : float
        Simulation: a motion has escaped at a distance of `far` sizes of the box of starts, or of `endless` times its start and its lengths.
    beside : float
        Starts: offset, in lengths, of a start that is itself an equilibrium; offset, in sizes of the box, of copies of a motion.
    recurs, nearly : float
        Recognition: largest distance of equal returns, relative to the size of the motion; distance below which a more accurate simulation is made.
    least : float
        Recognition: a state whose range is below this part of the largest range counts as constant.
    smallest : float
        Scales: smallest scale of a state, relative to the largest range or to the box.
    still : float
        Recognition: largest size, relative to the state, of a motion at rest.
    near : float
        Recognition: largest distance of a state from a motion to which it belongs, relative to the size of the motion.
    same : float
        Recognition: largest relative distance of equal points, cycles and equilibria; largest size of a cycle that is an equilibrium.
    at_rest : float
        Ends: size, in units of the scale, of a cycle that has shrunk to an equilibrium, and distance between the halves of a cycle that has become one of
        half the period.
    halving : float
        Ends: distance of a cycle from itself half a period later, relative to its size, below which it gets a mesh with equal halves.
    in_phase : float
        Phase: smallest cosine of the angle between the velocities of two cycles (averaged over the period) at which one keeps the phase of the other.
    homoclinic, longest : float
        Ends: a cycle counts as homoclinic at this distance from an equilibrium, relative to its size, or at this period, relative to the first one.
    touch : float
        Ends: step of differences at an event, in sizes of the cycle.
    error : float
        Errors: largest error of a cycle between its mesh points, relative to its size.
    sensible : float
        Errors: largest error of the trivial multiplier at which it is used as an estimate for the other multipliers.
    solved, rounded, diverged : float
        Newton's method, corrections in units of the scale: the last one; the largest one accepted when rounding stops convergence; one at which the method has
        diverged.
    agree : float
        Functions: largest relative difference of values that must be equal (one point or many in a call, mirror images).
    critical : float
        Hopf points: largest real part, relative to the largest eigenvalue, of a further critical pair.
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
        """Return settings from given values, with defaults for the others.

        Raises
        ------
        ValueError
            If there is no setting of a given name, or a value is no positive number.
        """
        if isinstance(given, FlowSettings):
            return given
        if not isinstance(given, Mapping | None):
            raise ValueError(f"settings = {given!r} must be values by name, such as {{'longest': 1e4}}")
        names = [field.name for field in fields(cls)]
        for name, value in (given or {}).items():
            if name not in names:
                raise ValueError(f"settings: there is no {name!r} of a flow{did_you_mean(name, names)}")
            if isinstance(value, bool) or not isinstance(value, (int, float)) or not value > 0.0:
                raise ValueError(f"settings: {name} = {value!r} must be a positive number")
        return cls(**(given or {}))

    def changed(self) -> dict[str, float]:
        """Return the settings that differ from the defaults."""
        return {name: value for name, value in asdict(self).items() if value != getattr(FlowSettings, name)}
