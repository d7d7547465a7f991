"""Closed-form motion of the oscillator and its absorber in each mode.

Between two events both masses obey linear equations with constant coefficients (lengths in units of the
half-width b, time tau = omega_0 t, q1 the oscillator, q2 the absorber, S the friction's sign):

    q1'' + eps lambda q1' + q1 = e + eps lambda e' - eps mu g S        q2'' = mu g S,     e = eps G sin Psi

* sliding, S = s = -1 or +1: q1 is a harmonic, a constant offset -eps mu g s and a damped oscillation; q2 a parabola.
* stuck: w = q1 - q2 keeps its value and both move as one mass,
  (1 + eps) q1'' + eps lambda q1' + q1 = e + eps lambda e', with S = q1''/(mu g) inside [-1, 1].

In both modes v = q1 + eps q2 accelerates by the force on the oscillator without friction,

    v'' = -q1 - eps lambda q1' + e + eps lambda e',       w'' = v'' - a S,       a = (1 + eps) mu g,

so stick, slip and turn read exactly as in the reduced model. Whatever the mode, q1 and its derivatives are

    c + P sin Psi + Q cos Psi + exp(-alpha tau) (A cos beta tau + B sin beta tau)

with the same alpha and beta: a *wave*. A wave's second derivative is bounded in closed form, which is what lets
`first_zero` step from zero to zero without ever missing one.

Everything here is compiled; quantities are scalars.
"""

import math

from contvines_ground.parts import part

TINY = 1e-300
NEAR = 0.03  # Taylor series to order 8 up to here: relative error below roundoff


@part(error_model="numpy")
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


@part(error_model="numpy")
def rates(mass, drag):
    """Decay rate alpha and angular frequency beta of mass z'' + drag z' + z = 0; beta is NaN when overdamped."""
    alpha = 0.5 * drag / mass
    square = 1.0 / mass - alpha * alpha
    if square <= 0.0:
        return alpha, math.nan
    return alpha, math.sqrt(square)


@part(error_model="numpy")
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


@part(error_model="numpy")
def oscillation(alpha, beta, z, z_rate):
    """Coefficients A, B of exp(-alpha tau) (A cos beta tau + B sin beta tau) with the given initial values."""
    return z, (z_rate + alpha * z) / beta


@part(error_model="numpy")
def derivative(Omega, alpha, beta, P, Q, A, B):
    """Coefficients P, Q, A, B of the derivative of a wave with respect to tau."""
    return -Omega * Q, Omega * P, beta * B - alpha * A, -beta * A - alpha * B


@part(error_model="numpy")
def wave(constant, P, Q, A, B, Omega, alpha, beta, phase, tau):
    """A wave's value and its derivative at time tau after the phase `phase`."""
    Psi = phase + Omega * tau
    s, c = math.sin(Psi), math.cos(Psi)
    decay = math.exp(-alpha * tau)
    C = decay * math.cos(beta * tau)
    S = decay * math.sin(beta * tau)
    value = constant + P * s + Q * c + A * C + B * S
    slope = Omega * (P * c - Q * s) + (beta * B - alpha * A) * C - (beta * A + alpha * B) * S
    return value, slope


@part(error_model="numpy")
def certain(y, y_rate, bound):
    """Time for which y > 0 stays positive when abs(y'') <= bound: the zero of y + y' h - bound h^2/2."""
    root = math.sqrt(y_rate * y_rate + 2.0 * bound * y)
    if y_rate > 0.0:
        return (root + y_rate) / bound
    return 2.0 * y / (root - y_rate)


@part(error_model="numpy")
def first_zero(constant, P, Q, A, B, Omega, alpha, beta, phase, start, end):
    """First zero of a wave in start < tau < end; `end` when there is none.

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
    scale = abs(constant) + abs(P) + abs(Q) + abs(A) + abs(B)
    tiny = 4e-16 * scale
    tau = start
    if bound <= TINY:
        return end, 0.0
    value, slope = wave(constant, P, Q, A, B, Omega, alpha, beta, phase, tau)
    if abs(value) <= tiny + 1e-15 * (1.0 + start + abs(phase)) * abs(slope):
        # leave the zero at the start: the slope decides the sign until 2 slope / bound
        tau += max(abs(slope) / bound, 1e-8)
        if tau >= end:
            return end, slope
        value, slope = wave(constant, P, Q, A, B, Omega, alpha, beta, phase, tau)
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
        value, slope = wave(constant, P, Q, A, B, Omega, alpha, beta, phase, tau)


@part(error_model="numpy")
def ahead(tau, h0, h1, z0, z1, omega, alpha, beta):
    """q1(tau) - q1(0), q1'(tau) - q1'(0), and h'', z'', h''', z''' at tau, for q1 = harmonic h + damped oscillation z + const.

    h0, h1 and z0, z1 are values and rates at the start.
    """
    square = omega * omega
    kappa = alpha * alpha + beta * beta
    if tau < NEAR:
        h2, h3 = -square * h0, -square * h1
        z2 = -2.0 * alpha * z1 - kappa * z0
        z3 = -2.0 * alpha * z2 - kappa * z1
        h4, h5 = -square * h2, -square * h3
        z4 = -2.0 * alpha * z3 - kappa * z2
        z5 = -2.0 * alpha * z4 - kappa * z3
        h6, h7, h8 = -square * h4, -square * h5, square * square * h4
        z6 = -2.0 * alpha * z5 - kappa * z4
        z7 = -2.0 * alpha * z6 - kappa * z5
        z8 = -2.0 * alpha * z7 - kappa * z6
        d2, d3, d4, d5, d6, d7, d8 = h2 + z2, h3 + z3, h4 + z4, h5 + z5, h6 + z6, h7 + z7, h8 + z8
        t = tau
        rate = t * (
            d2 + t / 2 * (d3 + t / 3 * (d4 + t / 4 * (d5 + t / 5 * (d6 + t / 6 * (d7 + t / 7 * d8)))))
        )  # fmt: skip
        way = t * (h1 + z1) + t * t / 2 * (
            d2 + t / 3 * (d3 + t / 4 * (d4 + t / 5 * (d5 + t / 6 * (d6 + t / 7 * (d7 + t / 8 * d8)))))
        )
        H2 = h2 + t * (h3 + t / 2 * (h4 + t / 3 * (h5 + t / 4 * (h6 + t / 5 * (h7 + t / 6 * h8)))))
        H3 = h3 + t * (h4 + t / 2 * (h5 + t / 3 * (h6 + t / 4 * (h7 + t / 5 * h8))))
        Z2 = z2 + t * (z3 + t / 2 * (z4 + t / 3 * (z5 + t / 4 * (z6 + t / 5 * (z7 + t / 6 * z8)))))
        Z3 = z3 + t * (z4 + t / 2 * (z5 + t / 3 * (z6 + t / 4 * (z7 + t / 5 * z8))))
        return way, rate, H2, Z2, H3, Z3
    angle = omega * tau
    s, c = math.sin(angle), math.cos(angle)
    H0 = h0 * c + h1 / omega * s
    H1 = h1 * c - omega * h0 * s
    decay = math.exp(-alpha * tau)
    angle = beta * tau
    cosine = decay * math.cos(angle)
    sine = decay * math.sin(angle) / beta
    Z0 = z0 * cosine + (z1 + alpha * z0) * sine
    Z1 = z1 * cosine - (alpha * z1 + kappa * z0) * sine
    Z2 = -2.0 * alpha * Z1 - kappa * Z0
    return (
        (H0 - h0) + (Z0 - z0),
        (H1 - h1) + (Z1 - z1),
        -square * H0,
        Z2,
        -square * H1,
        -2.0 * alpha * Z2 - kappa * Z1,
    )


@part(error_model="numpy")
def decompose(psi, w, rate, v, v_rate, eps, omega, X, Y, offset):
    """q1's harmonic h and oscillation z with their rates, and q2', of a state."""
    s, c = math.sin(psi), math.cos(psi)
    q2_rate = (v_rate - rate) / (1.0 + eps)
    q1 = (v + eps * w) / (1.0 + eps)
    h0 = X * s + Y * c
    h1 = omega * (X * c - Y * s)
    return h0, h1, q1 - h0 - offset, v_rate - eps * q2_rate - h1, q2_rate


@part(error_model="numpy")
def leg(state, params):
    """A state's closed form: h, h', z, z' at the start, alpha, beta, q2' and q2'' (q2' is of no use while stuck)."""
    G, omega, lam, eps, mu, g, chi = (
        params[0],
        params[1],
        params[2],
        params[3],
        params[5],
        params[6],
        params[7],
    )
    s = state[3]
    drag = eps * lam
    mass = 1.0 if s != 0.0 else 1.0 + eps
    X, Y = harmonic(eps * G, chi, drag * omega, 1.0 - mass * omega * omega)
    alpha, beta = rates(mass, drag)
    sp = s * mu * g
    h0, h1, z0, z1, q2_rate = decompose(
        state[0], state[1], state[2] if s != 0.0 else 0.0, state[6], state[7], eps, omega, X, Y, -eps * sp
    )
    return h0, h1, z0, z1, alpha, beta, q2_rate, sp
