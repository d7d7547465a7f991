"""Flights in closed form over any numbers (balls, jets): the machines as the proofs see them.

Written anew from the equations of motion, not from the compiled kernels: a proof must not inherit their slips. A flight
starts at a node and gives the motion at any forcing phase Psi; t = (Psi - Psi_0)/Omega is the time since its start.

Shaken cavity (`absorber`, `cavity`): v = C sin Psi and, in mode s,

    w'' = push - s a,    push = v'' + bias,    v'' = -C Omega^2 sin Psi,

with a = (1 + eps) mu g cos(slope), mu depending on the direction, and bias = -(1 + eps) g sin(slope) (the slope pulls to the right).

Absorber on its oscillator (`coupled`), e = eps G sin Psi:

    q1'' + eps lambda q1' + q1 = e + chi eps lambda e' - eps q2'',    q2'' = mu g cos(slope) s + g sin(slope),

so q1, counted from where all is at rest, is a harmonic of the forcing, a constant and a damped oscillation; stuck, both move as one mass 1 + eps.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Protocol

from orbits.proofs.jets import exp, sin_cos, sqrt
from orbits.proofs.obstacles import ProofError

if TYPE_CHECKING:
    from orbits.proofs.jets import Number

WALLS = {"L": 1, "R": -1}


@dataclass(frozen=True)
class Motion:
    """The motion at one instant: w with three rates, what pushes against friction with two, v and its rate."""

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


class Flights(Protocol):
    """A machine with closed-form flights and definite parameters."""

    limit: Mapping[int, Any]  # largest relative acceleration by friction against sliding in mode +1, -1
    room: Mapping[int, Any]  # distance of the left (+1) and the right wall (-1) from w = 0
    omega: Any

    def restitution(self, letter: str) -> Number:
        """Newton's coefficient of the wall."""
        ...

    def launch(self, letter: str, mode: int, node: Sequence[Number]) -> Flight:
        """The flight in `mode` that begins with event `letter` at `node`."""
        ...


def wall(flights: Flights, letter: str) -> Number:
    """Where the absorber hits at an impact."""
    side = WALLS[letter]
    return side * flights.room[side]


class Shaken:
    """Flights of a cavity that is shaken harmonically; node (Psi, B+) at impacts, (Psi, w) elsewhere."""

    node = 2
    moving_cavity = False

    limit: Mapping[int, Any]
    room: Mapping[int, Any]

    def __init__(self, p: Mapping[str, Any]) -> None:
        self.amplitude, self.omega = p["amplitude"], p["frequency"]
        weight = (1 + p["mass_ratio"]) * p["gravity"]
        if "slope" in p:
            sine, cosine = sin_cos(p["slope"])
            weight, self.bias = weight * cosine, -weight * sine
            self.limit = {1: weight * p["friction_left"], -1: weight * p["friction_right"], 0: 0}
            self.room = {1: p["distance_left"], -1: p["distance_right"]}
            self.left, self.right = p["restitution_left"], p["restitution_right"]
        else:
            a = weight * p["friction"]
            self.limit, self.room, self.bias = {1: a, -1: a, 0: 0}, {1: 1, -1: 1}, 0
            self.left = self.right = p["restitution"]

    def restitution(self, letter: str) -> Number:
        """Newton's coefficient of the wall."""
        return self.left if letter == "L" else self.right

    def launch(self, letter: str, mode: int, node: Sequence[Number]) -> Flight:
        """See `Flights.launch`."""
        phase0, y = node
        C, omega = self.amplitude, self.omega
        speed = C * omega
        peak = speed * omega
        s0, c0 = sin_cos(phase0)
        w0, beta = (wall(self, letter), y) if letter in WALLS else (y, speed * c0)
        pull = self.bias - mode * self.limit[mode]

        def flight(phase: Number) -> Motion:
            s, c = sin_cos(phase)
            shake, shake1 = -peak * s, -peak * omega * c
            shake2 = -omega * omega * shake
            push = shake + self.bias
            v, v1 = C * s, speed * c
            if mode == 0:
                return Motion(w0, 0, 0, 0, push, shake1, shake2, v, v1)
            t = (phase - phase0) / omega
            w = w0 + C * (s - s0) - (beta - pull * t / 2) * t
            return Motion(w, v1 - beta + pull * t, shake + pull, shake1, push, shake1, shake2, v, v1)

        return flight

    def resting(self, phase: Number) -> tuple[Any, Any]:
        """The push on the stuck absorber in steady state, and its rate."""
        s, c = sin_cos(phase)
        peak = self.amplitude * self.omega * self.omega
        return self.bias - peak * s, -peak * self.omega * c


class Coupled:
    """Flights of the absorber on its oscillator; node (Psi, B+, v, v') at impacts, (Psi, w, v, v') elsewhere."""

    node = 4
    moving_cavity = True
    limit: Mapping[int, Any]
    room: Mapping[int, Any]

    def __init__(self, p: Mapping[str, Any]) -> None:
        self.eps, self.omega = p["mass_ratio"], p["frequency"]
        self.whole = 1 + self.eps
        self.pull, self.lean = p["friction"] * p["gravity"], 0
        if "slope" in p:
            sine, cosine = sin_cos(p["slope"])
            self.pull, self.lean = self.pull * cosine, p["gravity"] * sine
        a, self.bias = self.whole * self.pull, -self.whole * self.lean
        self.limit, self.room = {1: a, -1: a, 0: 0}, {1: 1, -1: 1}
        self.r = p["restitution"]
        self.rate = self.eps * p["damping"]
        self._force, self._chi = self.eps * p["forcing"], p["excitation"]
        self._responses: dict[int, tuple[Number, Number, Number, Number]] = {}

    def restitution(self, letter: str) -> Number:
        """Newton's coefficient of the walls."""
        return self.r

    def _response(self, stuck: bool) -> tuple[Number, Number, Number, Number]:
        """X, Y of the forced response X sin Psi + Y cos Psi, and decay alpha and angular frequency beta of the free one."""
        if stuck not in self._responses:
            mass = self.whole if stuck else 1
            drag, stiffness = self.rate * self.omega, 1 - mass * self.omega * self.omega
            scale = self._force / (stiffness * stiffness + drag * drag)
            X = scale * (stiffness + self._chi * drag * drag)
            Y = scale * drag * (self._chi * stiffness - 1)
            alpha = self.rate / (2 * mass)
            one = self._force * 0 + 1
            self._responses[stuck] = X, Y, alpha, sqrt(one / mass - alpha * alpha)
        return self._responses[stuck]

    def launch(self, letter: str, mode: int, node: Sequence[Number]) -> Flight:
        """See `Flights.launch`."""
        phase0, y, v0, v1 = node
        eps, omega, whole = self.eps, self.omega, self.whole
        if letter in WALLS:
            w0, q2r = wall(self, letter), y / whole
            q1r = v1 - eps * q2r
        else:
            w0, q1r, q2r = y, v1 / whole, v1 / whole
        q1, q2 = (v0 + eps * w0) / whole, (v0 - w0) / whole
        X, Y, alpha, beta = self._response(mode == 0)
        slide = self.pull * mode + self.lean if mode else 0  # q2''
        offset = -eps * slide
        s0, c0 = sin_cos(phase0)
        z0 = q1 - X * s0 - Y * c0 - offset
        z1 = q1r - omega * (X * c0 - Y * s0)
        kappa = alpha * alpha + beta * beta

        def flight(phase: Number) -> Motion:
            t = (phase - phase0) / omega
            s, c = sin_cos(phase)
            sine, cosine = sin_cos(beta * t)
            decay = exp(-alpha * t)
            sine, cosine = decay * sine / beta, decay * cosine
            Z = z0 * cosine + (z1 + alpha * z0) * sine
            Z1 = z1 * cosine - (alpha * z1 + kappa * z0) * sine
            Z2 = -2 * alpha * Z1 - kappa * Z
            h, h1 = X * s + Y * c, omega * (X * c - Y * s)
            q, q_1 = offset + h + Z, h1 + Z1
            q_2 = Z2 - omega * omega * h
            Z3 = -2 * alpha * Z2 - kappa * Z1
            q_3 = Z3 - omega * omega * h1
            q_4 = -2 * alpha * Z3 - kappa * Z2 + omega * omega * omega * omega * h
            if mode == 0:
                v, rate = whole * q - eps * w0, whole * q_1
                return Motion(w0, 0, 0, 0, whole * q_2 + self.bias, whole * q_3, whole * q_4, v, rate)
            q2_1 = q2r + slide * t
            q2_0 = q2 + (q2r + slide * t / 2) * t
            push = q_2 + eps * slide + self.bias
            w, v = q - q2_0, q + eps * q2_0
            return Motion(w, q_1 - q2_1, q_2 - slide, q_3, push, q_3, q_4, v, q_1 + eps * q2_1)

        return flight

    def resting(self, phase: Number) -> tuple[Any, Any]:
        """The push on the stuck absorber in steady state, and its rate."""
        s, c = sin_cos(phase)
        X, Y, _, _ = self._response(True)
        size = -self.whole * self.omega * self.omega
        return size * (X * s + Y * c) + self.bias, size * self.omega * (X * c - Y * s)


MACHINES: dict[str, type[Shaken] | type[Coupled]] = {
    "absorber": Shaken,
    "cavity": Shaken,
    "coupled": Coupled,
}

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
    """The numbers that a machine's flights depend on.

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
