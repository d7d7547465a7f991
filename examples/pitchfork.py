"""A pitchfork and its perturbed twin: x' = h + p x - x^3 as an algebraic problem of one's own.

Perfect symmetry (h = 0) gives a branch point at p = 0. Any imperfection breaks it apart: a smooth branch, and
apart from it a branch with a fold at p = 3 (h/2)^(2/3) (Strogatz, Nonlinear Dynamics and Chaos, section 3.6).
"""

import contvines as cv


def perfect():
    """The graph of x' = p x - x^3 from the trivial solution."""
    problem = cv.AlgebraicProblem(
        lambda x, p: p * x - x**3, u0=[0.0], p0=-1.0, spectrum="flow", mirror=lambda x: -x
    )
    return cv.diagram(problem, within=(-1.0, 1.0))


def perturbed(h=0.02):
    """The graph of x' = h + p x - x^3 from its detached lower branch."""
    problem = cv.AlgebraicProblem(lambda x, p: h + p * x - x**3, u0=[-1.0], p0=0.95, spectrum="flow")
    return cv.diagram(problem, within=(-1.0, 1.0))


if __name__ == "__main__":
    for graph in (perfect(), perturbed()):
        print(graph, end="\n\n")
