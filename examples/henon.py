"""The period-doubling cascade of the Henon map, (x, y) -> (1 - a x^2 + y, b x) with b = 0.3.

In closed form: the fixed point has trace -2 a x and determinant -b, it doubles where 1 - 2 a x - b = 0, that is
at a = 3 (1 - b)^2 / 4 = 0.3675. The 2-cycle has x1 x2 = ((1 - b)^2 - a) / a^2, so trace 4 ((1 - b)^2 - a) + 2 b and
determinant b^2; it doubles where 1 + trace + determinant = 0, that is at a = (1 - b)^2 + (1 + b)^2 / 4 = 0.9125.
"""

import contvines as cv

B = 0.3


def henon(x, a):
    """One step of the map."""
    return [1.0 - a * x[0] ** 2 + x[1], B * x[0]]


def main():
    """The graph of fixed point, 2-cycle, 4-cycle and 8-cycle."""
    problem = cv.MapProblem(henon, u0=[0.63, 0.19], p0=0.0, parameter="a")
    return cv.diagram(problem, within=(-0.2, 1.1), depth=3)


if __name__ == "__main__":
    graph = main()
    print(graph)
    graph.plot(y="x0").savefig("henon.png")
