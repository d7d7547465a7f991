"""Responses to compare with (bare oscillator, tuned absorber of the same mass, plain friction damper), and a first clearance by theory.

Of each response the largest displacement of the oscillator under the same excitation, in closed form.
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
    """Complex displacement of the oscillator per force on it (over its mass), and of the tuned absorber of this mass ratio per that of the oscillator.

    Parameters
    ----------
    omega : float array
    rate : float
        Damping coefficient over the oscillator's mass, eps lambda.
    mass : float
        0 without an absorber.
    tuned_to : (float, float)
        As for `tuned`.
    """
    f, zeta = tuned_to
    link = f * f + 2.0j * zeta * omega  # of spring and damper, over the absorber's mass
    carried = link / (link - omega**2) if mass else np.zeros_like(link)
    return 1.0 / (1.0 - omega**2 + 1j * rate * omega - mass * omega**2 * carried), carried


def bare(
    frequency: ArrayLike, forcing: float, damping: float, mass_ratio: float, excitation: float = 1.0
) -> np.ndarray:
    """Amplitude of the oscillator alone, in half-widths.

    q1'' + eps lambda q1' + q1 = e + chi eps lambda e',  e = eps G sin(Omega tau): a force of one amplitude for chi = 0.

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
    """e + chi eps lambda e' of `bare`, complex."""
    return mass_ratio * forcing * (1.0 + 1j * excitation * rate * omega)


def tuning(mass_ratio: float) -> tuple[float, float]:
    """Den Hartog's tuned absorber on an undamped oscillator: frequency over that of the oscillator, and damping ratio.

    f = 1/(1 + mu) makes the two fixed points of the response equally high; zeta^2 = 3 mu/(8 (1 + mu)^3) is the mean of the two values that
    make one of them a maximum; zeta is c/(2 m omega_0). Source: J. P. Den Hartog, Mechanical Vibrations (1956), section 3.3.
    """
    return 1.0 / (1.0 + mass_ratio), math.sqrt(3.0 * mass_ratio / (8.0 * (1.0 + mass_ratio) ** 3))


def fixed_points(mass_ratio: float) -> tuple[float, float]:
    """The two frequencies at which the response of the tuned absorber does not depend on its damping (undamped oscillator).

    Omega^2 = (1 -+ sqrt(mu/(2 + mu)))/(1 + mu), where the amplification of a force is sqrt(1 + 2/mu).
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
    """Amplitude of the oscillator with a tuned absorber of mass ratio eps in place of the cavity, in half-widths.

    Parameters
    ----------
    frequency : array_like
    forcing, damping, mass_ratio, excitation : float
        As for `bare`.
    tuned_to : (float, float), optional
        Frequency over the oscillator's, and damping coefficient over twice the absorber's mass times the oscillator's frequency;
        Den Hartog's (`tuning`) by default.
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
    """Amplitude of the oscillator with a mass that slides or sticks on it, no walls, in half-widths.

    While friction (`pull` = mu g) holds, both move as one. Beyond, the first harmonic of the friction force is taken: with speed v of
    the oscillator and absorber's relative speed u, the absorber's equation gives its amplitude as (4/pi) pull/Omega and its phase by
    u^2 = v^2 - that^2, so that the oscillator sees eps times a complex mass that depends on its amplitude (first order in the harmonics, as
    in Den Hartog's one-term solution).
    """
    omega = np.atleast_1d(np.asarray(frequency, dtype=float))
    force = np.abs(_force(omega, forcing, mass_ratio * damping, mass_ratio, excitation))
    drag = mass_ratio * damping * omega
    stuck = force / np.abs(1.0 - (1.0 + mass_ratio) * omega**2 + 1j * drag)
    found = stuck.copy()
    own = (4.0 / math.pi) * pull  # first harmonic of friction, as an acceleration of the absorber
    for i in np.flatnonzero(stuck * omega**2 > own):
        found[i] = _sliding(float(omega[i]), float(force[i]), float(drag[i]), mass_ratio, own)
    return found.reshape(np.shape(frequency))


def _sliding(omega: float, force: float, drag: float, eps: float, own: float) -> float:
    """The amplitude q that balances `force` while the mass slides."""

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
    """One of `KINDS` at parameter vectors (m, P) of a machine with an oscillator, in half-widths, shape (m,).

    Raises
    ------
    ValueError
        If there is no such kind.
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
    """Half-widths by theory, in the machine's units of length.

    Attributes
    ----------
    linear_peak : float
        Of the oscillator at resonance, the absorber held fast.
    widest : float
        The best half-width where the absorber is at work (`orbits.multiple_scales.best_clearance`): wider ones are not entered at resonance.
    remaining : float
        The oscillator's amplitude at resonance that is left there.
    entered : float
        Below this half-width the absorber cannot stay calm at resonance: the oscillator's linear peak moves the walls as far as an absorber
        that stands still in space.
    """

    linear_peak: float
    widest: float
    remaining: float
    entered: float

    @property
    def safe(self) -> float:
        """The half-width to begin with: the best one that is entered from every start."""
        return min(self.widest, self.entered)


def first_clearance(model: Model, params: np.ndarray) -> FirstClearance | None:
    """Half-widths by theory; None for a machine without an oscillator or damping, with an inclined cavity, or whose absorber loses nothing at the walls.

    With F/k = eps G and 2 D = eps lambda/sqrt(1 + eps) the linear peak is F/(2 D k) = G sqrt(1 + eps)/lambda half-widths; it does not
    depend on the half-width in lengths. Friction is left out.

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
