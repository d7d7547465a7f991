"""The Brusselator, a chemical oscillator: x' = a + x^2 y - (b + 1) x, y' = b x - x^2 y. Put your own equations in its place."""

import contvines as cv


def rates(state, p):
    x, y = state
    return [p.a + x**2 * y - (p.b + 1) * x, p.b * x - x**2 * y]


flow = cv.FlowProblem(rates, [1.0, 1.5], {"a": 1.0, "b": 1.5}, states=("x", "y"))
