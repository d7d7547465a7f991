"""Closed-form motion of the oscillator and its absorber in each mode.

Between two events both masses obey linear equations with constant coefficients (lengths in units of the
half-width b, time tau = omega_0 t, q1 the oscillator, q2 the absorber, S the friction's sign):

    q1'' + eps lambda q1' + q1 = e + eps lambda e' - eps q2''        q2'' = mu g cos(slope) S + g sin(slope),     e = eps G sin Psi

(q1 is counted from where all is at rest, so that on a slope its spring carries the absorber's weight there)

* sliding, S = s = -1 or +1: q1 is a harmonic, a constant offset -eps q2'' and a damped oscillation; q2 a parabola.
* stuck: w = q1 - q2 keeps its value and both move as one mass,
  (1 + eps) q1'' + eps lambda q1' + q1 = e + eps lambda e', with S = (q1'' - g sin(slope))/(mu g cos(slope)) inside [-1, 1].

In both modes v = q1 + eps q2 accelerates by the force on the oscillator without friction,

    v'' = -q1 - eps lambda q1' + e + eps lambda e',       w'' = v'' - b - a S,       a = (1 + eps) mu g cos(slope),       b = (1 + eps) g sin(slope),

so stick, slip and turn read exactly as in the reduced model. Whatever the mode, q1 and its derivatives are

    c + P sin Psi + Q cos Psi + exp(-alpha tau) (A cos beta tau + B sin beta tau)

with the same alpha and beta: a *wave*. A wave's second derivative is bounded in closed form, which is what lets
`first_zero` step from zero to zero without ever missing one.

Quantities are scalars.
"""

import math

TINY = 1e-300


def harmonic(force, excitation, drag, stiffness):
    """Response of an oscillator to a moving base: force (sin Psi + excitation * drag cos Psi) -> X sin Psi + Y cos Psi.

    Parameters
    ----------
    force : float
        eps G.
    excitation : float
        1 when the base also acts through the damper, 0 when that term is dropped.
    drag : float
        eps lambda Omega.
    stiffness : float
        1 - mass * Omega**2, mass being 1 while sliding and 1 + eps while stuck.

    Returns
    -------
    X, Y : float
        In-phase and quadrature amplitudes; infinite at an undamped resonance.
    """
    size = stiffness * stiffness + drag * drag
    if force == 0.0:
        return 0.0, 0.0
    if size == 0.0:
        return math.inf, math.inf
    scale = force / size
    return scale * (stiffness + excitation * drag * drag), scale * drag * (excitation * stiffness - 1.0)


def rates(mass, drag):
    """Decay rate alpha and angular frequency beta of mass z'' + drag z' + z = 0; beta is NaN when overdamped."""
    alpha = 0.5 * drag / mass
    square = 1.0 / mass - alpha * alpha
    if square <= 0.0:
        return alpha, math.nan
    return alpha, math.sqrt(square)


def transition(alpha, beta, duration):
    """Entries of the 2x2 matrix that carries (z, z') over `duration`, and the two functions it is made of.

    Returns
    -------
    T11, T12, T21, T22, cosine, sine : float
        cosine = exp(-alpha d) cos(beta d), sine = exp(-alpha d) sin(beta d) / beta.
    """
    decay = math.exp(-alpha * duration)
    cosine = decay * math.cos(beta * duration)
    sine = decay * math.sin(beta * duration) / beta
    return (
        cosine + alpha * sine,
        sine,
        -(alpha * alpha + beta * beta) * sine,
        cosine - alpha * sine,
        cosine,
        sine,
    )


def oscillation(alpha, beta, z, z_rate):
    """Coefficients A, B of exp(-alpha tau) (A cos beta tau + B sin beta tau) with the given initial values."""
    return z, (z_rate + alpha * z) / beta


def derivative(Omega, alpha, beta, P, Q, A, B):
    """Coefficients P, Q, A, B of the derivative of a wave with respect to tau."""
    return -Omega * Q, Omega * P, beta * B - alpha * A, -beta * A - alpha * B


def wave(constant, P, Q, A, B, Omega, alpha, beta, phase, tau, drift=0.0):
    """A wave's value and its derivative at time tau after the phase `phase`, with `drift` times tau."""
    Psi = phase + Omega * tau
    s, c = math.sin(Psi), math.cos(Psi)
    decay = math.exp(-alpha * tau)
    C = decay * math.cos(beta * tau)
    S = decay * math.sin(beta * tau)
    value = constant + drift * tau + P * s + Q * c + A * C + B * S
    slope = drift + Omega * (P * c - Q * s) + (beta * B - alpha * A) * C - (beta * A + alpha * B) * S
    return value, slope


def certain(y, y_rate, bound):
    """Time for which y > 0 stays positive when abs(y'') <= bound: the zero of y + y' h - bound h^2/2."""
    root = math.sqrt(y_rate * y_rate + 2.0 * bound * y)
    if y_rate > 0.0:
        return (root + y_rate) / bound
    return 2.0 * y / (root - y_rate)


def first_zero(constant, P, Q, A, B, Omega, alpha, beta, phase, start, end, drift=0.0):
    """First zero of a wave with a drift in start < tau < end; `end` when there is none.

    With M >= abs(second derivative) on the interval, a value y > 0 with slope y' stays positive for at least
    2 y / (sqrt(y'**2 + 2 M y) - y'). Steps of that length approach a simple zero like Newton's method, from one side, and
    never jump over one. A zero at `start` itself is not counted: the slope there tells for how long there is no other.

    Returns
    -------
    tau, slope : float
        The zero and the wave's derivative there.
    """
    bound = Omega * Omega * math.hypot(P, Q) + (alpha * alpha + beta * beta) * math.exp(
        -alpha * start
    ) * math.hypot(A, B)
    scale = abs(constant) + abs(drift) * end + abs(P) + abs(Q) + abs(A) + abs(B)
    tiny = 4e-16 * scale
    tau = start
    if bound <= TINY:
        return end, 0.0
    value, slope = wave(constant, P, Q, A, B, Omega, alpha, beta, phase, tau, drift)
    if abs(value) <= tiny + 1e-15 * (1.0 + start + abs(phase)) * abs(slope):
        # leave the zero at the start: the slope decides the sign until 2 slope / bound
        tau += max(abs(slope) / bound, 1e-8)
        if tau >= end:
            return end, slope
        value, slope = wave(constant, P, Q, A, B, Omega, alpha, beta, phase, tau, drift)
    sign = 1.0 if value > 0.0 else -1.0
    while True:
        y, y_rate = sign * value, sign * slope
        if y <= tiny:
            return tau, slope
        step = certain(y, y_rate, bound)
        if step <= 2e-16 * (1.0 + tau):
            return tau, slope
        tau += step
        if tau >= end:
            return end, slope
        value, slope = wave(constant, P, Q, A, B, Omega, alpha, beta, phase, tau, drift)
