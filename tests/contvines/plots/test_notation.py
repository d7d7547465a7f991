"""Names are the user's: the notation of built-in machines labels the axes of these machines only."""

import matplotlib.pyplot as plt
import pytest

import contvines as cv
import orbits

OF_MACHINES = ["w", "B", "phase", "amplitude", "friction", "frequency", "half_width", "max_abs_q1"]


def labels(figure):
    found = {text for axes in figure.axes for text in (axes.get_xlabel(), axes.get_ylabel())}
    plt.close(figure)
    return found - {""}


@pytest.fixture(scope="module", params=OF_MACHINES)
def fold(request):
    """The fold u^2 = 1 - p against a parameter that is called as one of a built-in machine."""
    name = request.param
    problem = cv.AlgebraicProblem(
        lambda u, p: u**2 + p[name] - 1.0 + p["shift"], [1.0], {name: 0.0, "shift": 0.0}, parameter=name
    )
    return name, cv.diagram(problem, within=(-1.0, 2.0), depth=0)


def test_equations_of_the_users_own(fold):
    name, graph = fold
    plain = name.replace("_", " ")
    assert labels(graph.plot()) == {plain, "u0"}
    assert labels(graph.plot(y=name)) == {plain}


def test_a_built_in_machine_in_its_notation(tmp_path):
    absorber = orbits.Absorber(restitution=0.5, friction=0.1, gravity=0.2)
    graph = cv.diagram(absorber.orbit("LR", amplitude=0.5), over="amplitude", within=(0.45, 0.55), depth=0)
    wanted = {"amplitude $C$", "velocity at the first impact $B$"}
    assert labels(graph.plot()) == wanted
    graph.save(tmp_path / "a.vines")
    assert labels(cv.load(tmp_path / "a.vines").plot()) == wanted
    basins = cv.basins(absorber, "amplitude", at=0.5, points=4)
    figure = basins.plot()
    low, high = figure.axes[0].get_xlim()
    assert low > high  # the left wall, w = +1, stands on the left
    assert labels(figure) == {"position $w$ of the start", "velocity $w'$ of the start"}
