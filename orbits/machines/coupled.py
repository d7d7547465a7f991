"""The coupled machine: a mass with dry friction in a cavity on a driven linear oscillator."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from orbits.machines import coupled_orbits
from orbits.machines.base import Model
from orbits.machines.measures import DRIVEN
from orbits.machines.parameters import (
    FREQUENCY,
    FRICTION,
    GRAVITY,
    NOT_NEGATIVE,
    POSITIVE,
    RESTITUTION,
    SLOPE,
    Limits,
    Parameter,
    ParameterError,
)
from orbits.words import Word

if TYPE_CHECKING:
    from orbits.theory.multiple_scales import Equilibrium


@dataclass(frozen=True, kw_only=True)
class Coupled(Model):
    """A vibro-impact absorber on a linear oscillator with a shaken base, without approximation.

    ``q1'' + eps lambda q1' + q1 = e + eps lambda e' - eps q2'',    q2'' = mu g cos(slope) S + g sin(slope),    e = eps G sin(Omega tau)``,

    with S the sign of w' = q1' - q2' while sliding, ``|S| <= 1`` while stuck, ``|w| <= 1``, and w'+ = -r w'- at the walls with
    v = q1 + eps q2 and v' continuous. q1 and q2 count from the position of rest with the absorber in the middle. Lengths are in units of the
    cavity's half-width b, time tau = omega_0 t.

    Parameters
    ----------
    restitution : float
        Newton's coefficient r of the walls, 0 < r <= 1.
    friction : float
        Coulomb coefficient mu >= 0.
    gravity : float
        g / (b omega_0^2) >= 0.
    mass_ratio : float
        eps = m/M > 0.
    damping : float
        lambda = c/(m omega_0) >= 0; the oscillator must not be overdamped, eps lambda < 2.
    forcing : float, optional
        G = E/(b eps) >= 0, amplitude of the base over eps b. May be left to each orbit.
    frequency : float
        Omega > 0, excitation frequency over omega_0.
    excitation : {"exact", "truncated"} or float
        Whether the base also acts through the damper (eps lambda e', exact) or this term is dropped, as in the literature; a
        number from 0 to 1 keeps this share of the term.
    slope : float
        Angle of the cavity and of the oscillator's rail, in radians, from -pi/2 to pi/2; if positive, gravity pulls the absorber towards the
        right wall, w = -1.
    contact_time : float, optional
        Duration of an impact in 1/omega_0, only for the measure ``peak_force``; the motion does not depend on it.

    Raises
    ------
    ParameterError
        For impossible values; the message names field, value and remedy.

    Notes
    -----
    Source: Youssef, Karoui, Leine, the model section, with the terms that are dropped there. For data in SI units
    see `orbits.design.scales`.
    """

    restitution: float
    friction: float
    gravity: float
    mass_ratio: float
    damping: float = 0.9
    forcing: float | None = None
    frequency: float = 1.0
    excitation: str | float = "exact"
    slope: float = 0.0
    contact_time: float | None = field(default=None, repr=False)

    name = "coupled"
    moving_cavity: ClassVar[bool] = True
    default_measure: ClassVar[str] = "max_abs_q1"
    default_parameter = "frequency"
    driven_by: ClassVar[str] = "forcing"
    patience = 2  # an oscillator with a light absorber settles over thousands of periods
    closed_words: ClassVar[tuple[str, ...]] = ("LR", "tt")
    younger: ClassVar[tuple[str, ...]] = ("slope",)
    table: ClassVar[tuple[Parameter, ...]] = (
        Parameter("forcing", "amplitude of the base over eps b", NOT_NEGATIVE, "G", "", 3.3),
        FREQUENCY,
        Parameter("damping", "c / (m omega_0)", NOT_NEGATIVE, r"\lambda", "", 0.9),
        Parameter("mass_ratio", "absorber's mass over the oscillator's", POSITIVE, r"\varepsilon", "", 0.006),
        Parameter("restitution", "Newton's coefficient of the walls", RESTITUTION, "r", "", 0.76),
        FRICTION,
        GRAVITY,
        Parameter(
            "excitation",
            "the damper's share of the base's motion",
            Limits(0.0, 1.0),
            r"\chi",
            words={"exact": 1.0, "truncated": 0.0},
        ),
        Parameter("slope", "angle of the cavity", SLOPE, r"\alpha", "rad", 0.0),
    )
    own_measures: ClassVar[tuple[str, ...]] = tuple(DRIVEN)

    def _check_together(self) -> None:
        _underdamped(self.damping, self.mass_ratio)

    def vector(self, values: Mapping[str, Any] | None = None) -> np.ndarray:
        """Return the parameter vector, shape (9,); see `Model.vector`.

        Raises
        ------
        ParameterError
            Also for an overdamped oscillator and for a resonance without damping.
        """
        params = super().vector(values)
        forcing, omega, damping, eps = (float(value) for value in params[:4])
        _underdamped(damping, eps)
        if damping == 0.0 and forcing > 0.0:
            for mass, state in ((1.0, "sliding"), (1.0 + eps, "stuck")):
                if mass * omega * omega == 1.0:
                    raise ParameterError(
                        f"frequency = {omega:.17g} is the resonance of the oscillator (absorber {state}) and damping = 0: "
                        "the response has no bound; give a damping above 0 or another frequency"
                    )
        return params

    # ------------------------------------------------------------------ orbits
    def symmetric_orbit(self, fast: bool = True, **parameters: float):
        """Return the symmetric orbit `LR` with two impacts per period, in closed form.

        Parameters
        ----------
        fast : bool
            Of the two orbits at one frequency, the one with the faster absorber.
        **parameters
            Parameters that replace the machine's own.

        Raises
        ------
        ParameterError
            If there is no such orbit with these parameters.
        """
        params = self.vector(parameters)
        found = coupled_orbits.symmetric_nodes(params)
        if not found:
            raise ParameterError(
                f"frequency = {params[1]:g} and forcing = {params[0]:g} have no symmetric orbit with two impacts per "
                "period; go nearer to resonance or increase forcing"
            )
        return self._closed("LR", found[0 if fast else -1], params)

    def sliding_orbit(self, **parameters: float):
        """Return the symmetric sliding orbit `tt` about the middle of the cavity, in closed form.

        Raises
        ------
        ParameterError
            If the shaking is too weak to slide without sticking.
        """
        params = self.vector(parameters)
        nodes = coupled_orbits.sliding_nodes(params)
        if nodes is None:
            raise ParameterError(
                f"frequency = {params[1]:g} and forcing = {params[0]:g} shake too weakly for pure sliding; go nearer to "
                "resonance or increase forcing"
            )
        return self._closed("tt", nodes, params)

    def orbit_near(self, equilibrium: Equilibrium, **parameters: float):
        """Return the exact orbit, `LR` or `tt`, near a steady state of the slow flow.

        Parameters
        ----------
        equilibrium : orbits.theory.multiple_scales.Equilibrium
            Its detuning gives the frequency, 1 + mass_ratio * detuning.
        **parameters
            Parameters that replace the machine's own.

        Raises
        ------
        ParameterError
            On a slope: the slow flow is only for level cavities.
        """
        slope = float(parameters.get("slope", self.slope))
        if slope:
            raise ParameterError(
                f"slope = {slope:g}: the slow flow is that of level cavities; use slope = 0, or an attractor of the inclined machine"
            )
        eps = float(parameters.get("mass_ratio", self.mass_ratio))
        values = {"frequency": 1.0 + eps * equilibrium.detuning} | parameters
        params = self.vector(values)
        word = "LR" if equilibrium.manifold == "impacting" else "tt"
        guess = self._closed(word, coupled_orbits.nodes_from_equilibrium(params, equilibrium), params)
        return self.orbit(word, 1, guess.nodes, **values)

    def _closed(self, word: str, nodes: np.ndarray, params: np.ndarray):
        from orbits.orbit import Orbit

        reading = Word.parse(word, frictionless=self.frictionless(params))
        if reading.modes[0] != (-1 if word == "LR" else 1):
            nodes = _rotated(nodes)
        return Orbit(self, reading, 1, nodes, params)

    def start_nodes(self, word: Word, periods: int, params: np.ndarray) -> Iterator[np.ndarray]:
        """Yield the nodes of the words `LR`, `RL` and `tt` in closed form."""
        if periods != 1:
            return
        events = "".join(word.events)
        if events in ("LR", "RL"):
            for nodes in coupled_orbits.symmetric_nodes(params):
                yield nodes if events == "LR" else _rotated(nodes)
        elif events == "tt":
            nodes = coupled_orbits.sliding_nodes(params, int(word.mode_codes[0]))
            if nodes is not None:
                yield nodes

    def stuck_response(self, **parameters: float) -> coupled_orbits.StuckResponse:
        """Return the linear response with the absorber stuck, and whether friction holds it."""
        return coupled_orbits.stuck_response(self.vector(parameters))

    def stuck_frequencies(self, **parameters: float) -> np.ndarray:
        """Return the frequencies at which the stuck response begins or ceases to slip, ascending."""
        return coupled_orbits.stuck_frequencies(self.vector(parameters))


def _rotated(nodes: np.ndarray) -> np.ndarray:
    """Return two nodes, beginning with the second one."""
    return np.array([nodes[1], nodes[0] + [2.0 * np.pi, 0.0, 0.0, 0.0]])


def _underdamped(damping: float, mass_ratio: float) -> None:
    if damping * mass_ratio >= 2.0 or not math.isfinite(damping * mass_ratio):
        raise ParameterError(
            f"damping = {damping:g} with mass_ratio = {mass_ratio:g} overdamps the oscillator: keep damping * mass_ratio "
            "below 2"
        )
