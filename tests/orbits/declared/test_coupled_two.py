"""Two absorbers on one oscillator: against a plain integration of Newton's laws with events, and the machine with one absorber."""

import json
import math
import pickle
from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import contvines as cv
from contvines.command.compose import first_orbit
from contvines.command.study import check_study
from contvines.command.survey_study import dissipation
from contvines.survey.outcomes import Findings
from orbits import Coupled, Machine, coupled_two
from orbits.attractors.sweeping import sweep
from orbits.machines.coupled_two import _motion
from orbits.machines.page.checks import check_response
from orbits.problem import rebuild
from orbits.simulation import simulate

START = {"q": 20.0, "x1": 20.0, "x2": 20.0}
VALUES = dict(zip(coupled_two.parameter_names, coupled_two.vector(), strict=True))


def newton(values, start, count):
    """(letter, seconds, q, x1, x2) of the first events in metres and seconds: forces on three bodies, impulses between two, by scipy's DOP853."""
    p = dict(values)
    M, E, omega, rate = (
        p["oscillator_mass"],
        1e-3 * p["base_amplitude"],
        *(2 * math.pi * p[n] for n in ("frequency", "natural_frequency")),
    )
    stiffness, damper = M * rate**2, 2 * p["damping_ratio"] * M * rate
    masses = [p[f"absorber_mass_{i}"] for i in (1, 2)]
    room = [1e-3 * p[f"clearance_{i}"] for i in (1, 2)]
    holds = [p[f"friction_{i}"] * p["gravity"] for i in (1, 2)]
    y = np.array([start.get(name, 0.0) for name in coupled_two.states]) * [1e-3, 1e-3, 1e-3, 1.0, 1.0, 1.0]
    modes, t, found = [int(np.sign(y[3] - y[4 + i])) for i in (0, 1)], 0.0, []

    def force(t, y):
        return stiffness * (E * math.sin(omega * t) - y[0]) + damper * (
            E * omega * math.cos(omega * t) - y[3]
        )

    def rates(t, y):
        moving = [i for i in (0, 1) if modes[i]]
        heavy = M + sum(masses[i] for i in (0, 1) if not modes[i])
        a = (force(t, y) - sum(modes[i] * masses[i] * holds[i] for i in moving)) / heavy
        return [*y[3:], a, *(modes[i] * holds[i] if modes[i] else a for i in (0, 1))]

    def choose(i, t, y):
        """The mode of an absorber that has come to rest in its cavity."""
        modes[i] = 0
        a = rates(t, y)[3]
        modes[i] = 0 if abs(a) <= holds[i] else int(np.sign(a))

    for i in (0, 1):
        if not modes[i]:
            choose(i, t, y)
    while len(found) < count:
        watch = []
        for i in (0, 1):
            s = modes[i]
            slips = (lambda t, y, i=i, s=s: abs(rates(t, y)[3]) - holds[i]) if not s else None
            halts = (lambda t, y, i=i, s=s: s * (y[3] - y[4 + i])) if s else slips
            hits = (lambda t, y, i=i, s=s: room[i] - s * (y[0] - y[1 + i])) if s else (lambda t, y: 1.0)
            for event, direction in ((halts, -1 if s else 1), (hits, -1)):
                event.terminal, event.direction = True, direction
                watch.append(event)
        run = solve_ivp(rates, (t, t + 10.0), y, events=watch, method="DOP853", rtol=1e-12, atol=1e-15)
        t, y = float(run.t[-1]), run.y[:, -1]
        k = next(k for k, times in enumerate(run.t_events) if times.size)
        i, s = k // 2, modes[k // 2]
        if k % 2:
            r, m = p[f"restitution_{i + 1}"], masses[i]
            impulse = (1 + r) * (y[3] - y[4 + i]) * m * M / (m + M)
            y[3], y[4 + i] = y[3] - impulse / M, y[4 + i] + impulse / m
            modes[i] = -s
            letter = "L" if s > 0 else "R"
        elif s == 0:
            modes[i] = int(np.sign(rates(t, y)[3]))
            letter = "u"
        else:
            y[4 + i] = y[3]
            choose(i, t, y)
            letter = "t" if modes[i] else "s"
        found.append((f"{letter}{i + 1}", t, *y[:3]))
        if not modes[1 - i]:  # the other one may not bear it
            choose(1 - i, t, y)
            found += [(f"u{2 - i}", t, *y[:3])] if modes[1 - i] else []
    return found[:count]


@pytest.mark.parametrize("frequency", [7.8, 8.0])
def test_events_are_those_of_newton_s_laws(frequency):
    expected = newton(VALUES | {"frequency": frequency}, START, 25)
    run = simulate(coupled_two, START, events=25, frequency=frequency)
    assert list(run.letters)[:25] == [row[0] for row in expected]
    seconds = run.clocks[1:26] / (2 * math.pi * frequency)
    np.testing.assert_allclose(seconds, [row[1] for row in expected], atol=1e-9)


def test_a_light_second_absorber_leaves_the_machine_with_one():
    light = {"absorber_mass_2": 1e-12, "frequency": 8.1}
    two = coupled_two.attractor(START, **light).orbit
    mass, clearance, rate = VALUES["absorber_mass_1"] / VALUES["oscillator_mass"], 0.015, 2 * math.pi * 8.0
    one = Coupled(
        restitution=0.6, friction=0.1, gravity=9.81 / (clearance * rate**2), mass_ratio=mass, damping=2 * 0.007 / mass,
        forcing=0.3e-3 / (clearance * mass), frequency=8.1 / 8.0,
    )  # fmt: skip
    start = {"q1": 20.0 / 15.0, "q2": 20.0 / 15.0}
    alone = one.attractor(start).orbit
    assert [letter[0] for letter in two.word.events if letter.endswith("1")].count(
        "L"
    ) == alone.word.events.count("L")
    q = two.sample(2000)["q"]
    assert np.abs(q).max() / 15.0 == pytest.approx(alone.measure("max_abs_q1"), rel=1e-5)


def test_orbits_have_words_of_both_absorbers_and_are_followed():
    orbit = coupled_two.attractor(START, frequency=8.2).orbit
    assert {letter[1] for letter in orbit.word.events} == {"1", "2"}
    assert orbit.real and orbit.stable and orbit.replay() < 1e-9


def test_a_study_names_it_and_its_file_needs_no_trust():
    study = check_study({
        "model": {"name": "coupled_two", "absorber_mass_2": 0.02},
        "start": {"word": "L1 R2 R1 L2", "periods": 1, "frequency": 8.2},
        "continue": {"parameter": "frequency", "within": [8.1, 8.4]},
    })  # fmt: skip
    assert study.model is coupled_two and study.loose["absorber_mass_2"] == 0.02
    problem = coupled_two.attractor(START, frequency=8.2).orbit.problem("frequency")
    again = rebuild(json.loads(json.dumps(problem.describe())))
    assert again is not None and again.model is coupled_two


@pytest.mark.slow
def test_a_study_begins_elsewhere_where_nothing_recurs_in_the_middle(capsys):
    study = check_study({
        "model": {"name": "coupled_two", "clearance_1": 5.0, "clearance_2": 3.0},
        "continue": {"parameter": "frequency", "within": [7.0, 9.0]},
    })  # fmt: skip
    orbit = first_orbit(study)
    assert orbit.real and 7.0 < orbit.parameters["frequency"] < 9.0
    assert "settles from rest at frequency" in capsys.readouterr().err


def test_dissipated_powers_are_losses_over_the_period():
    orbit = coupled_two.attractor(START, frequency=8.2).orbit
    graph = cv.diagram(orbit, over="frequency", within=(8.195, 8.205), depth=0)
    found = dissipation(Findings(graph, orbit))
    branch = graph["B1"]
    top: Any = branch.orbit(int(np.argmax(branch.measure("max_abs_q"))))  # the response that a diagram shows
    for name in ("impact", "friction"):
        power = 1e3 * top.measure(f"{name}_loss") * top.parameters["frequency"]  # mW
        assert found[f"{name}_power"] == pytest.approx(power, rel=1e-3)


def test_its_response_is_how_far_the_oscillator_goes():
    orbit = coupled_two.attractor(START, frequency=8.2).orbit
    problem = orbit.problem("frequency")
    assert problem.default_measure == "max_abs_q" and coupled_two.units["max_abs_q"] == "mm"
    assert orbit.measure("max_q") == pytest.approx(orbit.sample(4000)["q"].max(), rel=1e-6)
    with pytest.raises(
        ValueError, match="response = 'max_x1': expected max_q, min_q, max_abs_q, approach_speed"
    ):
        check_response("max_x1", coupled_two.states, coupled_two.contacts)


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


def test_an_absorber_that_sticks_at_its_wall_does_not_hit_it_and_both_slip_at_once():
    at_wall = {"x2": -10.0}
    assert (
        len(simulate(coupled_two, at_wall, periods=50, events=100, base_amplitude=1e-3)) == 0
    )  # held for ever
    seconds, step = 2 * math.pi * 8.0, 1e-6  # equal frictions give way, and hold again, at one instant
    expected = sorted((round(row[1] / step), row[0], row[1]) for row in newton(VALUES, at_wall, 4))
    run = simulate(coupled_two, at_wall, events=4)
    assert list(run.letters) == [row[1] for row in expected] == ["u1", "u2", "s1", "s2"]
    np.testing.assert_allclose(run.clocks[1:] / seconds, [row[2] for row in expected], atol=1e-9)


@pytest.mark.parametrize(
    ("frequency", "amplitude", "q", "rate", "rate_1"),
    [(7.4, 0.12, 0.37, -0.0026, 0.014), (7.6, 0.2, -0.25, -0.04, -0.041), (7.4, 0.3, -0.044, 0.034, 0.079)],
)
def test_a_heavy_absorber_that_comes_to_rest_makes_the_other_one_slip(frequency, amplitude, q, rate, rate_1):
    start = {"q": q, "q_rate": rate, "x1_rate": rate_1, "x2_rate": rate}
    own = {"frequency": frequency, "base_amplitude": amplitude, "friction_1": 0.3, "friction_2": 0.05}
    expected = newton(VALUES | own | {"absorber_mass_1": 0.5}, start, 6)
    run = simulate(coupled_two, start, events=6, absorber_mass_1=0.5, **own)
    assert list(run.letters) == [row[0] for row in expected] and 0.0 in np.diff(run.clocks)
    np.testing.assert_allclose(
        run.clocks[1:] / (2 * math.pi * frequency), [row[1] for row in expected], atol=1e-9
    )


def test_turns_at_one_instant_have_one_order_on_which_the_motion_does_not_depend():
    walls, (first, second) = coupled_two.contacts[:4], coupled_two.contacts[4:]
    told = {*coupled_two.states, *coupled_two.parameters}
    other = Machine(
        name="other", states=coupled_two.states, parameters=dict(coupled_two.parameters), phase_rate="frequency",
        motion=_motion, contacts=[*walls, second, first],
        units={name: unit for name, unit in coupled_two.units.items() if name in told},
    )  # fmt: skip
    generator, times = np.random.default_rng(1), np.linspace(0.0, 5.0, 300)[:-1]
    seen = 0
    for heavy in (0.032, 1.0) * 3:  # the heavy one makes the light one turn, stick and slip with it
        q, x, v, w = generator.uniform(-2.0, 2.0, 4)
        start = {"q": q, "q_rate": v / 10, "x1": x, "x2": x, "x1_rate": w / 10, "x2_rate": w / 10}
        run, turned = (
            simulate(machine, start, periods=5, absorber_mass_1=heavy) for machine in (coupled_two, other)
        )
        assert np.abs(run.coordinates(times) - turned.coordinates(times)).max() < 1e-9
        for one, order in ((run, "12"), (turned, "21")):
            at_once = set(np.flatnonzero(np.diff(one.clocks[1:]) == 0.0))
            pairs = [(one.letters[k], one.letters[k + 1]) for k in at_once if k - 1 not in at_once]
            orders = [x[1] + y[1] for x, y in pairs if x[0] == y[0]]
            assert set(orders) <= {order}
            seen += len(orders)
    assert seen > 20


@pytest.mark.parametrize("excess", [0.0, 1.8e-15, 5e-13])
def test_an_absorber_leaves_or_presses_its_wall_however_its_gap_is_rounded(excess):
    """Away from the left wall as Newton's laws say (time stood still); at the right one it stays in its cavity (it fell through the wall)."""
    expected = newton(VALUES, {"x1": -15.0}, 4)
    away = simulate(coupled_two, {"x1": -15.0 - excess}, events=4)
    assert sorted(away.letters[:2]) == ["u1", "u2"] and sorted(away.letters[2:]) == ["s1", "s2"]
    seconds = away.clocks[1:5] / (2 * math.pi * 8.0)
    np.testing.assert_allclose(seconds, [row[1] for row in expected], atol=1e-9)
    pressed = simulate(coupled_two, {"x2": 10.0 + excess}, events=12, friction_1=0.02)
    q, x2 = pressed.states[:, 0], pressed.states[:, 2]
    assert "(R2" in pressed.letters and np.abs(q - x2).max() < 10.0 + 1e-9


def test_it_goes_to_other_processes_and_a_machine_without_a_name_says_why_not():
    again = pickle.loads(pickle.dumps(coupled_two))
    assert again.settings() == coupled_two.settings()
    ball = Machine(
        name="ball", states=("x", "v"), parameters={"g": 1.0}, motion=lambda s, phase, p, contact: (s.v, -p.g)
    )
    with pytest.raises(ValueError, match="'ball' cannot go to another process"):
        pickle.dumps(ball)
