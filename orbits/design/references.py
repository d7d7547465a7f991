"""Reference responses for comparison (bare oscillator, tuned absorber of the same mass, friction damper), and a first clearance by theory.

Each reference response is the displacement amplitude of the oscillator under the same excitation, in closed form.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike
from scipy.optimize import root_scalar

from contvines.shared.numbers import ROUNDED
from orbits.settings import DESIGNING

if TYPE_CHECKING:
    from orbits.machines.base import Model


KINDS = ("bare", "tuned", "friction")
NAMES = {
    "bare": "bare oscillator",
    "tuned": "tuned absorber of the same mass",
    "friction": "friction damper, no walls",
}


def compliance(
    omega: np.ndarray, rate: float, mass: float = 0.0, tuned_to: tuple[float, float] = (1.0, 0.0)
) -> tuple[np.ndarray, np.ndarray]:
    """Return two complex frequency responses of an oscillator with a tuned absorber.

    Parameters
    ----------
    omega : float array
        Frequencies, relative to the natural one.
    rate : float
        Damping coefficient over the oscillator's mass, eps lambda.
    mass : float
        Mass ratio of the tuned absorber; 0 for none.
    tuned_to : (float, float)
        As for `tuned`.

    Returns
    -------
    complex array
        Displacement of the oscillator per force on it over its mass.
    complex array
        Displacement of the absorber relative to that of the oscillator.
    """
    f, zeta = tuned_to
    link = f * f + 2.0j * zeta * omega  # complex stiffness of spring and damper, over the absorber's mass
    carried = link / (link - omega**2) if mass else np.zeros_like(link)
    return 1.0 / (1.0 - omega**2 + 1j * rate * omega - mass * omega**2 * carried), carried


def bare(
    frequency: ArrayLike, forcing: float, damping: float, mass_ratio: float, excitation: float = 1.0
) -> np.ndarray:
    """Amplitude of the oscillator without absorber, in half-widths.

    q1'' + eps lambda q1' + q1 = e + chi eps lambda e',  e = eps G sin(Omega tau); with chi = 0 a force whose amplitude does not depend on the frequency.

    Parameters
    ----------
    frequency : array_like
        Omega.
    forcing, damping, mass_ratio, excitation : float
        G, lambda, eps and chi, as in `orbits.Coupled`.
    """
    omega, rate = np.asarray(frequency, dtype=float), mass_ratio * damping
    return np.abs(_force(omega, forcing, rate, mass_ratio, excitation) * compliance(omega, rate)[0])


def _force(
    omega: np.ndarray, forcing: float, rate: float, mass_ratio: float, excitation: float
) -> np.ndarray:
    """Complex amplitude of the force e + chi eps lambda e' of `bare`."""
    return mass_ratio * forcing * (1.0 + 1j * excitation * rate * omega)


def tuning(mass_ratio: float) -> tuple[float, float]:
    """Tuning of Den Hartog's absorber on an undamped oscillator: frequency relative to that of the oscillator, and damping ratio.

    f = 1/(1 + mu) makes the two fixed points of the response equally high. zeta^2 = 3 mu/(8 (1 + mu)^3), with zeta = c/(2 m omega_0), is the mean of
    the two values for which one fixed point is a maximum. Source: J. P. Den Hartog, Mechanical Vibrations (1956), section 3.3.
    """
    return 1.0 / (1.0 + mass_ratio), math.sqrt(3.0 * mass_ratio / (8.0 * (1.0 + mass_ratio) ** 3))


def fixed_points(mass_ratio: float) -> tuple[float, float]:
    """Two frequencies at which the response does not depend on the damping of the tuned absorber (undamped oscillator).

    Omega^2 = (1 -+ sqrt(mu/(2 + mu)))/(1 + mu); the response to a force is there sqrt(1 + 2/mu) times the static one.
    """
    share = math.sqrt(mass_ratio / (2.0 + mass_ratio))
    low, high = ((1.0 - share) / (1.0 + mass_ratio), (1.0 + share) / (1.0 + mass_ratio))
    return math.sqrt(low), math.sqrt(high)


def tuned(
    frequency: ArrayLike,
    forcing: float,
    damping: float,
    mass_ratio: float,
    excitation: float = 1.0,
    tuned_to: tuple[float, float] | None = None,
) -> np.ndarray:
    """Amplitude of the oscillator with a tuned absorber instead of the impact absorber, in half-widths.

    Parameters
    ----------
    frequency : array_like
        Omega.
    forcing, damping, mass_ratio, excitation : float
        As for `bare`; the tuned absorber has the mass ratio eps.
    tuned_to : (float, float), optional
        Frequency of the absorber relative to that of the oscillator, and damping ratio c/(2 m omega_0); default: Den Hartog's (`tuning`).
    """
    omega, rate = np.asarray(frequency, dtype=float), mass_ratio * damping
    carrying, _ = compliance(omega, rate, mass_ratio, tuned_to or tuning(mass_ratio))
    return np.abs(_force(omega, forcing, rate, mass_ratio, excitation) * carrying)


def friction_damper(
    frequency: ArrayLike,
    forcing: float,
    damping: float,
    mass_ratio: float,
    pull: float,
    excitation: float = 1.0,
) -> np.ndarray:
    """Amplitude of the oscillator with a mass that slides or sticks on it, without walls, in half-widths.

    While friction (`pull` = mu g) holds the mass, both move as one. Beyond, the friction force is replaced by its first harmonic (harmonic
    balance, as in Den Hartog's one-term solution). The absorber then moves with the speed amplitude s = (4/pi) pull/Omega; with the speed
    amplitude v of the oscillator, that of the relative motion is u with u^2 = v^2 - s^2. So the absorber acts on the oscillator as a
    complex mass that depends on the amplitude.
    """
    omega = np.atleast_1d(np.asarray(frequency, dtype=float))
    force = np.abs(_force(omega, forcing, mass_ratio * damping, mass_ratio, excitation))
    drag = mass_ratio * damping * omega
    stuck = force / np.abs(1.0 - (1.0 + mass_ratio) * omega**2 + 1j * drag)
    found = stuck.copy()
    friction = (4.0 / math.pi) * pull  # first harmonic of friction, as an acceleration of the absorber
    for i in np.flatnonzero(stuck * omega**2 > friction):
        found[i] = _sliding(float(omega[i]), float(force[i]), float(drag[i]), mass_ratio, friction)
    return found.reshape(np.shape(frequency))


def _sliding(omega: float, force: float, drag: float, eps: float, own: float) -> float:
    """Solve for the amplitude q at which the response balances `force` while the mass slides; inf without a solution."""

    def missing(q: float) -> float:
        share = min(own / (q * omega**2), 1.0)
        mass = 1.0 + eps * share**2
        loss = drag + eps * omega**2 * share * math.sqrt(1.0 - share**2)
        return q * math.hypot(1.0 - mass * omega**2, loss) - force

    low = own / omega**2
    high = max(2.0 * low, 1.0)
    while missing(high) < 0.0:
        high *= 2.0
        if high > DESIGNING.endless:
            return math.inf
    return float(root_scalar(missing, bracket=(low, high), xtol=ROUNDED).root)


def reference(kind: str, model: Model, params: np.ndarray) -> np.ndarray:
    """Return one reference response of a machine with an oscillator, in half-widths.

    Parameters
    ----------
    kind : str
        One of `KINDS`.
    model : Model
    params : float array (m, P)
        Parameter vectors.

    Returns
    -------
    float array (m,)

    Raises
    ------
    ValueError
        If the kind is unknown.
    """
    if kind not in KINDS:
        raise ValueError(f"{kind!r} is no response to compare with; choose one of {', '.join(KINDS)}")
    names = ("frequency", "forcing", "damping", "mass_ratio", "excitation")
    found = np.empty(len(params))
    for i, row in enumerate(params):
        f, G, lam, eps, chi = (float(model.column(row, name)) for name in names)
        if kind == "friction":
            pull = float(model.column(row, "friction") * model.column(row, "gravity"))
            value = friction_damper(f, G, lam, eps, pull, chi)
        else:
            value = (bare if kind == "bare" else tuned)(f, G, lam, eps, chi)
        found[i] = float(value)
    return found


@dataclass(frozen=True)
class FirstClearance:
    """Half-widths of the cavity by theory, in the machine's units of length.

    Attributes
    ----------
    linear_peak : float
        Amplitude of the oscillator at resonance with the absorber fixed to it.
    widest : float
        The best half-width with a working absorber (`orbits.theory.multiple_scales.best_clearance`); in wider cavities the working motion
        does not exist at resonance.
    remaining : float
        Amplitude of the oscillator at resonance with the half-width `widest`.
    entered : float
        Below this half-width the absorber cannot stay calm at resonance: the linear peak of the oscillator moves the walls up to an absorber
        that stands still in space.
    """

    linear_peak: float
    widest: float
    remaining: float
    entered: float

    @property
    def safe(self) -> float:
        """Half-width for a first design: the best one at which the absorber works from every start."""
        return min(self.widest, self.entered)


def first_clearance(model: Model, params: np.ndarray) -> FirstClearance | None:
    """Return half-widths by theory; None for a machine without oscillator, damping or forcing, with an inclined cavity, or with elastic walls.

    With F/k = eps G and 2 D = eps lambda/sqrt(1 + eps) the linear peak is F/(2 D k) = G sqrt(1 + eps)/lambda half-widths; as a length
    it does not depend on the half-width. Friction is neglected.

    Parameters
    ----------
    model : Model
    params : float array (P,)
    """
    from orbits.theory.multiple_scales import SlowFlow, best_clearance

    numbers = model.named(params)
    damping, forcing = numbers.get("damping", 0.0), numbers.get("forcing", 0.0)
    if numbers.get("slope", 0.0) != 0.0 or not (
        damping > 0.0 and forcing > 0.0 and 0.0 < numbers["restitution"] < 1.0
    ):
        return None
    eps = numbers["mass_ratio"]
    flow = SlowFlow(restitution=numbers["restitution"], friction=0.0, mass_ratio=eps, damping=damping)
    best = best_clearance(flow)
    peak = forcing * math.sqrt(1.0 + eps) / damping * float(model.gauge("length", params))
    return FirstClearance(peak, best.ratio * peak, best.reduction * peak, peak)
