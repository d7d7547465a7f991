"""A branch that leaves a symmetry breaking so flatly that its parameter is lost in rounding at first."""

import numpy as np

import contvines as cv
from contvines.bifurcation.kinds import BY_NAME
from orbits import Coupled
from tools.fuzz.between import Between


def test_rounding_is_no_fold():
    """Its frequency grows like the square of the distance, to 2.5e-11 at the first point: beside the branch point it goes to and fro.

    The witness of folds is the outermost multiplier: it leaves 1 upwards and does not come back to it.
    """
    machine = Coupled(
        restitution=0.8534841620779452,
        friction=0.8680529238996338,
        gravity=0.9386654651703923,
        mass_ratio=0.006,
        damping=0.36493306751966925,
        forcing=2.4115915054517867,
        frequency=1.0216953595742364,
        excitation="truncated",
    )
    reach = 0.3 * np.sqrt(machine.mass_ratio)
    within = (machine.frequency - reach, machine.frequency + reach)
    graph = cv.diagram(machine.orbit(""), within=within, over="frequency", depth=2)
    breaking = next(p for p in graph.of_kind("symmetry-breaking") if abs(p.value - 0.99867243) < 1e-8)
    side = next(b for b in graph if b.seed == breaking.label)
    kinds = [graph[label].kind for _, label in side.marks if label != breaking.label]
    assert kinds == ["neimark-sacker", "neimark-sacker", "stick"]
    assert all(point.kind in BY_NAME for point in graph.special.values())
    between = Between(side, graph.within)
    outermost = [np.abs(between.orbit(i, 0.5).multipliers).max() for i in range(1, len(side) - 1)]
    assert np.all(np.array(outermost) > 1.0 - 1e-9)
