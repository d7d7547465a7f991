"""A border right beside a symmetry breaking: what goes on there is the motion of less symmetry, not the symmetric one nearby."""

import numpy as np

import contvines as cv
from orbits import Coupled
from orbits.simulation import simulate


def simulated(orbit):
    """w over the forcing periods of an orbit, from the start that its first node names."""
    start = {
        "phase": orbit.nodes[0, 0] % (2 * np.pi),
        "w": orbit.events.w[0],
        "w_rate": orbit.events.rate_post[0],
        "v": orbit.nodes[0, 2],
        "v_rate": orbit.events.v_rate[0],
    }
    run = simulate(orbit.model, start, periods=orbit.periods, **orbit.parameters)
    first = start["phase"]
    return run.sample(first + np.linspace(1e-6, 2 * np.pi * orbit.periods - 1e-6, 400)).w


def test_the_symmetric_motion_nearby_is_not_taken_for_it():
    """An impact vanishes where the motion LttRtt is asymmetric by two thousandths, 4e-9 from where it becomes symmetric."""
    machine = Coupled(
        restitution=0.23818632640220908, friction=0.44527788458221196, gravity=0.4473161606145934, mass_ratio=0.002,
        damping=0.4249649921653641, forcing=2.2861292630111993,
    )  # fmt: skip
    guess = [
        [6.3176134, 1.6559805, -1.524797, 1.0705306], [6.7153472, 0.8904357, -0.9904947, 1.5764732],
        [7.6133904, 1.7559976, 0.617836, 1.7559966], [9.4598397, -1.6570495, 1.5241155, -1.0714955],
        [9.8579461, -0.890331, 0.9889034, -1.5774678], [10.7540144, -0.9991821, -0.6161337, -1.7565925],
    ]  # fmt: skip
    start = machine.orbit("LtLRtt", guess=guess, frequency=0.9983871391129215)
    graph = cv.diagram(start, over="frequency", within=(0.9975, 0.9989), depth=0)
    border = next(
        point
        for point in graph.of_kind("wall-graze")
        if point.branch == "B1" and abs(point.value - 0.998385152814) < 1e-9
    )
    beyond = [graph[switch.target] for switch in graph.switches if switch.point == border.label]
    beyond = [branch for branch in beyond if branch.description["word"] == "LttRtt"]
    assert len(beyond) == 1 and not beyond[0].problem.symmetric
    (place,) = [place for place, label in beyond[0].marks if label == border.label]
    here, there = border.orbit, beyond[0].orbit(place)
    shared = [
        (k, j)
        for k, node in enumerate(here.nodes)
        for j, other in enumerate(there.nodes)
        if abs((node[0] - other[0] + np.pi) % (2 * np.pi) - np.pi) < 1e-4
        and here.word.events[k] == there.word.events[j] == "L"
    ]
    k, j = shared[0]
    assert np.abs(simulated(here.rotate(k)) - simulated(there.rotate(j))).max() < 1e-4
