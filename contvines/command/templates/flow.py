"""Van der Pol's oscillator: x'' - mu (1 - x^2) x' + x = 0."""

import contvines as cv


def rates(x, p):
    return [x[1], p.mu * (1.0 - x[0] ** 2) * x[1] - x[0]]


flow = cv.FlowProblem(rates, [0.0, 0.0], {"mu": -0.5})
