"""Closed forms of flights for proofs, over any kind of numbers (balls, jets).

They are derived from the equations of motion independently of the compiled kernels, so that a proof does not contain errors of these. A flight
starts at a node and returns the motion at any forcing phase Psi; t = (Psi - Psi_0)/Omega is the time since its start.

Shaken cavity (`absorber`, `cavity`): v = C sin Psi and, in mode s,

    w'' = push - s a,    push = v'' + bias,    v'' = -C Omega^2 sin Psi,

with a = (1 + eps) mu g cos(slope), where mu depends on the direction of sliding, and bias = -(1 + eps) g sin(slope) (gravity pulls to the right).

Absorber on its oscillator (`coupled`), e = eps G sin Psi:

    q1'' + eps lambda q1' + q1 = e + chi eps lambda e' - eps q2'',    q2'' = mu g cos(slope) s + g sin(slope),

so q1, measured from the position of rest, is the sum of a harmonic of the forcing, a constant and a damped oscillation. While the absorber
sticks, both move as one mass 1 + eps.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from orbits.proofs.jets import exp, sin_cos, sqrt
from orbits.proofs.obstacles import ProofError

if TYPE_CHECKING:
    from orbits.proofs.jets import Number, Row

WALLS = {"L": 1, "R": -1}


@dataclass(frozen=True)
class Motion:
    """The motion at one instant: w with three time derivatives, the push against friction with two, v with one."""

    w: Any
    w1: Any
    w2: Any
    w3: Any
    push: Any
    push1: Any
    push2: Any
    v: Any
    v1: Any


Flight = Callable[["Number"], Motion]


class Flights:
    """Flights of a machine with given parameters.

    A node is (Psi, B+) at an impact and (Psi, w) at other events; it also contains v and v' if the cavity has a motion of its own.
    A shaken cavity is treated as the coupled machine with eps = 0, with q1 = v = C sin Psi independent of the absorber, and q2 multiplied by 1 + eps.

    Attributes
    ----------
    limit : dict
        Mode (+1, -1) -> largest relative acceleration by friction against sliding in this mode; 0 -> 0.
    room : dict
        Side -> distance of the left (+1) and of the right wall (-1) from w = 0.
    """

    def __init__(self, p: Mapping[str, Any], moving_cavity: bool) -> None:
        self.moving_cavity, self.omega, self.p = moving_cavity, p["frequency"], p
        weight = (1 + p["mass_ratio"]) * p["gravity"]
        sine, cosine = sin_cos(p["slope"]) if "slope" in p else (0, 1)
        left, right = (
            {
                name: p.get(f"{name}_{side}", p.get(name, 1))
                for name in ("friction", "restitution", "distance")
            }
            for side in ("left", "right")
        )
        self.bias = -weight * sine
        self.limit: dict[int, Any] = {
            s: weight * cosine * side["friction"] for s, side in ((1, left), (-1, right))
        } | {0: 0}
        self.room: dict[int, Any] = {1: left["distance"], -1: right["distance"]}
        self._restitution = {"L": left["restitution"], "R": right["restitution"]}
        self.eps = p["mass_ratio"] if moving_cavity else 0
        self.whole = 1 + self.eps
        self._responses: dict[bool, tuple[Any, Any, Any, Any]] = {}

    def restitution(self, letter: str) -> Number:
        """Coefficient of restitution of the wall."""
        return self._restitution[letter]

    def _response(self, stuck: bool) -> tuple[Any, Any, Any, Any]:
        """Return X, Y of the forced response X sin Psi + Y cos Psi of q1, and decay rate alpha and angular frequency beta of its free oscillation."""
        p = self.p
        if not self.moving_cavity:
            return p["amplitude"], 0, 0, 0
        if stuck not in self._responses:
            rate, force, chi = self.eps * p["damping"], self.eps * p["forcing"], p["excitation"]
            mass = self.whole if stuck else 1
            drag, stiffness = rate * self.omega, 1 - mass * self.omega * self.omega
            scale = force / (stiffness * stiffness + drag * drag)
            alpha = rate / (2 * mass)
            self._responses[stuck] = (
                scale * (stiffness + chi * drag * drag),
                scale * drag * (chi * stiffness - 1),
                alpha,
                sqrt((force * 0 + 1) / mass - alpha * alpha),
            )
        return self._responses[stuck]

    def launch(self, letter: str, mode: int, node: Row) -> Flight:
        """Return the flight in `mode` that begins with event `letter` at `node`, as a function of the phase."""
        phase0, y = node[:2]
        eps, omega, whole = self.eps, self.omega, self.whole
        X, Y, alpha, beta = self._response(mode == 0)
        s0, c0 = sin_cos(phase0)
        v0, v1 = node[2:] if self.moving_cavity else (X * s0, X * omega * c0)
        w0, q2r = (wall(self, letter), y / whole) if letter in WALLS else (y, v1 / whole)
        slide = (mode * self.limit[mode] - self.bias) / whole if mode else 0  # q2''
        z0 = z1 = kappa = 0
        if self.moving_cavity:
            z0 = (v0 + eps * w0) / whole - X * s0 - Y * c0 + eps * slide
            z1 = (v1 - eps * q2r if letter in WALLS else q2r) - omega * (X * c0 - Y * s0)
            kappa = alpha * alpha + beta * beta

        def flight(phase: Number) -> Motion:
            t = (phase - phase0) / omega
            s, c = sin_cos(phase)
            h, h1, square = X * s + Y * c, omega * (X * c - Y * s), omega * omega
            moved, q1, q2, q3, q4 = (
                X * (s - s0) + Y * (c - c0),
                h1,
                -square * h,
                -square * h1,
                square * square * h,
            )
            if self.moving_cavity:
                sine, cosine = sin_cos(beta * t)
                decay = exp(-alpha * t)
                sine, cosine = decay * sine / beta, decay * cosine
                Z = z0 * cosine + (z1 + alpha * z0) * sine
                Z1 = z1 * cosine - (alpha * z1 + kappa * z0) * sine
                Z2 = -2 * alpha * Z1 - kappa * Z
                Z3 = -2 * alpha * Z2 - kappa * Z1
                moved, q1, q2, q3 = moved + Z - z0, q1 + Z1, q2 + Z2, q3 + Z3
                q4 = q4 - 2 * alpha * Z3 - kappa * Z2
            if mode == 0:
                push = whole * q2 + self.bias
                return Motion(w0, 0, 0, 0, push, whole * q3, whole * q4, v0 + whole * moved, whole * q1)
            slid, fall, push = (q2r + slide * t / 2) * t, q2r + slide * t, q2 + eps * slide + self.bias
            v, rate = v0 + moved + eps * slid, q1 + eps * fall
            return Motion(w0 + moved - slid, q1 - fall, q2 - slide, q3, push, q3, q4, v, rate)

        return flight

    def resting(self, phase: Number) -> tuple[Any, Any]:
        """Return the push on the stuck absorber in the steady state, and its time derivative."""
        s, c = sin_cos(phase)
        X, Y, _, _ = self._response(True)
        size = -self.whole * self.omega * self.omega
        return size * (X * s + Y * c) + self.bias, size * self.omega * (X * c - Y * s)


def wall(flights: Flights, letter: str) -> Number:
    """Position w of the absorber at an impact."""
    side = WALLS[letter]
    return side * flights.room[side]


MOVING = frozenset({"coupled"})
"""Machines whose cavity has a motion of its own."""

_EVERY = ("gravity", "mass_ratio", "frequency")
_SIDES = tuple(
    f"{name}_{side}" for name in ("restitution", "friction", "distance") for side in ("left", "right")
)
NAMES: dict[str, tuple[str, ...]] = {
    "absorber": ("amplitude", "restitution", "friction", *_EVERY),
    "cavity": ("amplitude", "slope", *_SIDES, *_EVERY),
    "coupled": ("forcing", "damping", "restitution", "excitation", "friction", "slope", *_EVERY),
}


def parameter_names(machine: str) -> tuple[str, ...]:
    """Return the names of the numbers on which a machine's flights depend.

    Raises
    ------
    ProofError
        If the machine has no flights in closed form.
    """
    if machine not in NAMES:
        raise ProofError(
            f"the machine {machine!r} has no flights in closed form, so its orbits cannot be proved; machines that have: "
            + ", ".join(NAMES)
        )
    return NAMES[machine]
