"""Flows that several tests follow, each written once, and their cycles by shooting: scipy's DOP853 with the variational equations, nothing of the package's."""

from types import SimpleNamespace

import numpy as np
from scipy.integrate import solve_ivp
from scipy.optimize import fsolve


def landau(x, p):
    """Stuart and Landau's oscillator: a circle of radius sqrt(mu), passed in 2 pi, with the multiplier exp(-4 pi mu)."""
    growth = p.mu - x[0] ** 2 - x[1] ** 2
    return [growth * x[0] - x[1], x[0] + growth * x[1]]


def van_der_pol(x, p):
    return [x[1], p.mu * (1 - x[0] ** 2) * x[1] - x[0]]


def born(x, p):
    """Van der Pol's oscillator in units in which its cycles are born at a = 0."""
    return [x[1], -x[0] + (p.a - x[0] ** 2) * x[1]]


def nerve(x, p):
    """FitzHugh and Nagumo's."""
    return [x[0] - x[0] ** 3 / 3 - x[1] + p.current, p.e * (x[0] + 0.7 - 0.8 * x[1])]


def neuron(x, p):
    """Hindmarsh and Rose's."""
    return [
        x[1] - x[0] ** 3 + 3 * x[0] ** 2 - x[2] + p.current,
        1 - 5 * x[0] ** 2 - x[1],
        0.01 * (4 * (x[0] + 1.6) - x[2]),
    ]


def prey_and_predator(x, p):
    """Of Rosenzweig and MacArthur: below zero they escape; above they coexist, at rest where prey is d / (e - d h) = 2 / 3."""
    eaten = x[0] * x[1] / (1 + 0.5 * x[0])
    return [x[0] * (1 - x[0] / p.k) - eaten, 0.6 * eaten - 0.3 * x[1]]


def unit_circle(states):
    """Moments and states of a motion that goes once round it in 2 pi, all further states at rest."""
    times = np.linspace(0.0, 2.0 * np.pi, 101)
    turning = np.column_stack([np.cos(times), np.sin(times)])
    return times, np.pad(turning, ((0, 0), (0, states - 2)))


def run(f, x, time, /, rtol=1e-11, forced=None, **values):
    """The state after some time; f (x, p), or (x, p, t) where it is forced."""
    p = SimpleNamespace(**values)
    forced = is_forced(f) if forced is None else forced

    def rate(t, y):
        return f(y, p, t) if forced else f(y, p)

    return solve_ivp(rate, (0.0, time), x, method="DOP853", rtol=rtol, atol=0.1 * rtol).y[:, -1]


def is_forced(f):
    return f.__code__.co_argcount > 2


def jacobian(f, x, *of):
    """Derivatives of f (x, ...) by the state, by complex steps."""
    return np.transpose([np.imag(f(x + 1e-30j * unit, *of)) * 1e30 for unit in np.eye(len(x))])


def after(f, x, time, /, **values):
    """State and its derivatives by the first one after some time."""
    d = len(x)

    def rate(y, *p):
        return np.concatenate([f(y[:d], *p), (jacobian(f, y[:d], *p) @ y[d:].reshape(d, d)).ravel()])

    end = run(rate, [*x, *np.eye(d).ravel()], time, 1e-12, is_forced(f), **values)
    return end[:d], end[d:].reshape(d, d)


def cycle(f, x, period, /, **values):
    """Period and derivatives of the return of the cycle through the first number of x."""

    def missed(v):
        start = [x[0], *v[:-1]]
        return after(f, start, v[-1], **values)[0] - start

    found = fsolve(missed, [*x[1:], period], xtol=1e-13)
    return found[-1], after(f, [x[0], *found[:-1]], found[-1], **values)[1]


def doubled(f, x, time, /, image=1.0, **value):
    """Where the return after this time, or its image, has the multiplier -1: the value of the parameter. Of flows that are not forced time is free."""
    ((name, near),), free = value.items(), not is_forced(f)

    def missed(v):
        start, last = ([x[0], *v[:-2]], v[-1]) if free else (v[:-1], time)
        end, matrix = after(f, start, last, **{name: v[-1 - free]})
        return [*(image * end - start), np.linalg.det(image * matrix + np.eye(len(x)))]

    return fsolve(missed, [*x[free:], near, *[time] * free], xtol=1e-12)[-1 - free]
