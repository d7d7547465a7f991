"""Numbers of special points that are worked out when they are asked for."""

from dataclasses import dataclass, replace

import contvines as cv
from contvines.branches.lazy_field import Later
from orbits import Absorber


@dataclass
class Held:
    name: str
    number: Later = Later()  # noqa: RUF009


def test_a_number_is_worked_out_once():
    calls = []

    def work():
        calls.append(None)
        return 2.5

    held = Held("a")
    assert held.number is None
    held.number = work
    assert not calls
    assert held.number == 2.5
    assert held.number == 2.5
    assert len(calls) == 1
    held.number = 3.0
    assert held.number == 3.0
    other = Held("b", number=work)
    assert replace(other, name="c").number == 2.5
    assert len(calls) == 2


def test_a_graph_that_is_kept_has_all_numbers(tmp_path):
    machine = Absorber(restitution=0.76, friction=0.5, gravity=0.211, mass_ratio=0.006)
    orbit = machine.orbit("LR", 1, amplitude=0.55, frequency=1.0)
    graph = cv.diagram(orbit, over="amplitude", within=(0.5, 0.8), depth=1)
    graph.save(tmp_path / "a.vines")
    kept = cv.load(tmp_path / "a.vines")
    point = kept["SB1"]
    assert point.coefficient == graph["SB1"].coefficient is not None
    assert point.replay == graph["SB1"].replay < 1e-9
