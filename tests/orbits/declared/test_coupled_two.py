"""Two absorbers on one oscillator, against a plain integration of Newton's laws with events."""

import json
import math
import pickle
from typing import Any

import numpy as np
import pytest

import contvines as cv
from contvines.command.compose import first_orbit
from contvines.command.study import check_study
from contvines.command.survey_study import dissipation
from contvines.survey.outcomes import Findings
from orbits import Machine, coupled_two
from orbits.attractors import find_attractor
from orbits.attractors.sweeping import sweep
from orbits.population import Population
from orbits.problem import rebuild
from orbits.simulation import simulate
from tests.orbits.machines.coupled.equations_of_motion import Mass, integrate

START = {"q": 20.0, "x1": 20.0, "x2": 20.0}
VALUES = dict(zip(coupled_two.parameter_names, coupled_two.vector(), strict=True))
AT = {"frequency": 7.8, "clearance_1": 15.0, "clearance_2": 10.0}


def newton(changes, start, count):
    """Letters and instants of the first events, in metres and seconds; of what happens at once, in the order of letters."""
    p = VALUES | changes
    mass, omega, rate = (
        p["oscillator_mass"],
        *(2 * math.pi * p[n] for n in ("frequency", "natural_frequency")),
    )
    size, stiffness, damper = 1e-3 * p["base_amplitude"], mass * rate**2, 2 * p["damping_ratio"] * mass * rate

    def force(t, q, v):
        return stiffness * (size * math.sin(omega * t) - q) + damper * (
            size * omega * math.cos(omega * t) - v
        )

    absorbers = [
        Mass(*(p[f"{name}_{i}"] * unit for name, unit in (
            ("absorber_mass", 1.0), ("clearance", 1e-3), ("restitution", 1.0), ("friction", p["gravity"])
        )))
        for i in (1, 2)
    ]  # fmt: skip
    y = np.array([start.get(name, 0.0) for name in coupled_two.states]) * [1e-3, 1e-3, 1e-3, 1.0, 1.0, 1.0]
    return in_order(event[:2] for event in integrate(force, mass, absorbers, y, count, atol=1e-15))


def in_order(events):
    return list(zip(*sorted(events, key=lambda event: (round(event[1] * 1e6), event[0]))))


HEAVY = {"absorber_mass_1": 0.5, "friction_1": 0.3, "friction_2": 0.05}
RUNS = [
    ({"frequency": 7.8}, START, 25),
    ({}, START, 25),
    # an absorber that sticks at its wall does not hit it: both slip at once
    ({}, {"x2": -10.0}, 3),
    # it leaves its wall however its gap is rounded
    *(({}, {"x1": -15.0 - excess}, 4) for excess in (0.0, 1.8e-15, 5e-13)),
    # a heavy absorber that comes to rest makes the other one slip
    *(
        (HEAVY | {"frequency": frequency, "base_amplitude": amplitude}, {"q": q, "q_rate": v, "x1_rate": v1, "x2_rate": v}, 6)
        for frequency, amplitude, q, v, v1 in (
            (7.4, 0.12, 0.37, -0.0026, 0.014), (7.6, 0.2, -0.25, -0.04, -0.041), (7.4, 0.3, -0.044, 0.034, 0.079),
        )
    ),
]  # fmt: skip


@pytest.mark.parametrize(("changes", "start", "count"), RUNS)
def test_events_are_those_of_newton_s_laws(changes, start, count):
    letters, instants = newton(changes, start, count)
    run = simulate(coupled_two, start, events=count, **changes)
    seconds = run.clocks[1:] / (2 * math.pi * changes.get("frequency", 8.0))
    found, times = in_order(zip(run.letters, seconds))
    assert found == letters
    np.testing.assert_allclose(times, instants, atol=1e-9)
    assert count > 6 or 0.0 in np.diff(run.clocks)


def test_what_is_held_at_a_wall_stays_there():
    assert len(simulate(coupled_two, {"x2": -10.0}, periods=50, events=100, base_amplitude=1e-3)) == 0
    for excess in (0.0, 1.8e-15, 5e-13):
        pressed = simulate(coupled_two, {"x2": 10.0 + excess}, events=12, friction_1=0.02)
        q, x2 = pressed.states[:, 0], pressed.states[:, 2]
        assert "(R2" in pressed.letters and np.abs(q - x2).max() < 10.0 + 1e-9


@pytest.mark.parametrize("amplitude", [7e3, 7e4])
def test_both_pressed_to_their_walls_hop_no_more(amplitude):
    """A swing of a thousand clearances decays like that of the oscillator with both masses on it, within what the impacts take as well."""
    run = simulate(
        coupled_two, {"q": amplitude, "x1": amplitude + 15.0, "x2": amplitude + 10.0}, periods=60, **AT
    )
    assert run.lasted == pytest.approx(60.0) and len(run) < 200 * 2 * 60
    share = 3.8 / (3.8 + 0.032 + 0.016)  # of the mass that is the oscillator's
    rate = 2.0 * np.pi * 8.0 * np.sqrt(share)
    decay = np.exp(-0.007 * 2.0 * np.pi * 8.0 * share * 60 / 7.8)
    q, speed = run.last[0], 1000.0 * run.last[3]  # mm, mm/s
    assert np.hypot(q, speed / rate) == pytest.approx(decay * amplitude, rel=0.08)


def test_turns_at_one_instant_have_one_order_on_which_the_motion_does_not_depend():
    walls, (first, second) = coupled_two.contacts[:4], coupled_two.contacts[4:]
    told = {*coupled_two.states, *coupled_two.parameters}
    other = Machine(
        name="other", states=coupled_two.states, parameters=dict(coupled_two.parameters), phase_rate="frequency",
        motion=coupled_two.equations.formulas_of_motion, contacts=[*walls, second, first],
        units={name: unit for name, unit in coupled_two.units.items() if name in told},
    )  # fmt: skip
    generator, times, seen = np.random.default_rng(1), np.linspace(0.0, 5.0, 300)[:-1], 0
    for heavy in (0.032, 1.0) * 3:  # the heavy one makes the light one turn, stick and slip with it
        q, x, v, w = generator.uniform(-2.0, 2.0, 4)
        start = {"q": q, "q_rate": v / 10, "x1": x, "x2": x, "x1_rate": w / 10, "x2_rate": w / 10}
        runs = [
            simulate(machine, start, periods=5, absorber_mass_1=heavy) for machine in (coupled_two, other)
        ]
        assert np.abs(runs[0].coordinates(times) - runs[1].coordinates(times)).max() < 1e-9
        for run, order in zip(runs, ("12", "21")):
            at_once = set(np.flatnonzero(np.diff(run.clocks[1:]) == 0.0))
            pairs = [run.letters[k] + run.letters[k + 1] for k in at_once if k - 1 not in at_once]
            orders = [pair[1::2] for pair in pairs if pair[0] == pair[2]]
            assert set(orders) <= {order}
            seen += len(orders)
    assert seen > 20


def test_where_an_absorber_slides_freely_does_not_make_another_motion():
    """No force and no impact of the other one knows its position: shifted it is the same motion."""
    drawn = np.random.default_rng(3).uniform(-1, 1, 6) * [0.004, 0.01, 0.008, 0.2, 0.2, 0.2]
    orbit = find_attractor(coupled_two, np.concatenate([[0.0], drawn]), **AT).orbit
    hits = {text for text in orbit.word.events if text[0] in "LR"}
    assert orbit.periods == 1 and hits in ({"L1", "R1"}, {"L2", "R2"})
    population = Population(coupled_two, "frequency", AT)
    starts = np.array([np.concatenate([[0.0], drawn])] * 4)[:, -population.starts(1, 0, 7.8).shape[1] :]
    # metres; it lies between its walls still
    starts[:, -5 if hits == {"L2", "R2"} else -4] += [0.0, 0.0005, -0.001, 0.0015]
    motions, index, _ = population.settle(starts, 7.8)
    words = [motions[k].word for k in set(index.tolist()) if motions[k].kind == "periodic"]
    assert words and len(set(words)) == len(words)


# ---------------------------------------------------------------------------------------------- orbits and studies
@pytest.fixture(scope="module")
def orbit():
    return coupled_two.attractor(START, frequency=8.2).orbit


def test_orbits_have_words_of_both_absorbers_and_are_followed(orbit):
    """The response is how far the oscillator goes; a file of such orbits needs no trust."""
    assert {letter[1] for letter in orbit.word.events} == {"1", "2"}
    assert orbit.real and orbit.stable and orbit.replay() < 1e-9
    assert orbit.measure("max_q") == pytest.approx(orbit.sample(4000)["q"].max(), rel=1e-6)
    problem = orbit.problem("frequency")
    assert problem.default_measure == "max_abs_q" and coupled_two.units["max_abs_q"] == "mm"
    assert rebuild(json.loads(json.dumps(problem.describe()))).model is coupled_two
    assert pickle.loads(pickle.dumps(coupled_two)).settings() == coupled_two.settings()


def test_a_study_names_it():
    study = check_study({
        "model": {"name": "coupled_two", "absorber_mass_2": 0.02},
        "start": {"word": "L1 R2 R1 L2", "periods": 1, "frequency": 8.2},
        "continue": {"parameter": "frequency", "within": [8.1, 8.4]},
    })  # fmt: skip
    assert study.model is coupled_two and study.loose["absorber_mass_2"] == 0.02


@pytest.mark.slow
def test_a_study_begins_elsewhere_where_nothing_recurs_in_the_middle(capsys):
    study = check_study({
        "model": {"name": "coupled_two", "clearance_1": 5.0, "clearance_2": 3.0},
        "continue": {"parameter": "frequency", "within": [7.0, 9.0]},
    })  # fmt: skip
    orbit = first_orbit(study)
    assert orbit.real and 7.0 < orbit.parameters["frequency"] < 9.0
    assert "settles from rest at frequency" in capsys.readouterr().err


def test_dissipated_powers_are_losses_over_the_period(orbit):
    graph = cv.diagram(orbit, over="frequency", within=(8.195, 8.205), depth=0)
    found, branch = dissipation(Findings(graph, orbit)), graph["B1"]
    top: Any = branch.orbit(int(np.argmax(branch.measure("max_abs_q"))))  # the response that a diagram shows
    for name in ("impact", "friction"):
        power = 1e3 * top.measure(f"{name}_loss") * top.parameters["frequency"]  # mW
        assert found[f"{name}_power"] == pytest.approx(power, rel=1e-3)


def test_the_response_of_a_motion_and_of_its_mirror_image_is_one():
    """9.5022 mm to one side, 9.3288 mm to the other: Newton's laws from event to event by DOP853, 300 periods from rest."""
    machine = {
        "oscillator_mass": 5.1, "natural_frequency": 5.6, "damping_ratio": 0.012, "absorber_mass_1": 0.09, "absorber_mass_2": 0.04,
        "clearance_1": 9.0, "clearance_2": 13.0, "restitution_1": 0.7, "restitution_2": 0.55, "friction_1": 0.07, "friction_2": 0.04,
        "base_amplitude": 0.45, "frequency": 5.586,
    }  # fmt: skip
    one = coupled_two.attractor(**machine).orbit
    half = {name: -value for name, value in zip(coupled_two.states, one.nodes[0, 1:])}
    other = coupled_two.attractor(half | {"phase": one.nodes[0, 0] + math.pi}, **machine).orbit
    assert sorted([one.measure("max_q"), other.measure("max_q")]) == pytest.approx([9.3288, 9.5022], abs=1e-4)
    for orbit in (one, other):
        assert orbit.measure("max_abs_q") == pytest.approx(9.5022, abs=1e-4)
    (row,) = sweep(coupled_two, "frequency", [5.586], **machine)
    assert row.measures["max_abs_q"] == pytest.approx(9.5022, abs=1e-3)
