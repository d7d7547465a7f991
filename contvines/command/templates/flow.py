"""The Brusselator, a chemical oscillator: x' = a - (b + 1) x + x^2 y, y' = b x - x^2 y."""

import contvines as cv


def rates(x, p):
    reaction = x[0] ** 2 * x[1]
    return [p.a - (p.b + 1.0) * x[0] + reaction, p.b * x[0] - reaction]


flow = cv.FlowProblem(rates, [1.0, 1.0], {"b": 1.0, "a": 1.0})
