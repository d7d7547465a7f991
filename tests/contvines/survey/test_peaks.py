"""The peak is that of all stable motions: sliding ones in closed form, drawn machines from simulations."""

import numpy as np
import pytest
from scipy.optimize import minimize_scalar

import contvines as cv
from contvines.graph.stretches import not_simulated, spread
from contvines.survey import PlanError, survey
from orbits import coupled_two
from orbits.attractors.sweeping import sweep
from orbits.design import Family
from orbits.machines.physical import physical
from tests.contvines.survey.circles import Circles
from tools.benchmarks.peaks import drawn, judged

pytestmark = pytest.mark.slow

M, HERTZ, ZETA, BASE, FRICTION, G = 3.2, 8.0, 0.01, 2e-3, 0.1553939, 9.81
SMALL = 0.032
CASE = {
    "oscillator_mass": f"{M} kg", "natural_frequency": f"{HERTZ} Hz", "damping_ratio": ZETA, "absorber_mass": f"{SMALL} kg",
    "half_width": "110 mm", "restitution": 0.6903254, "friction": FRICTION, "base_amplitude": "2 mm", "frequency": f"{HERTZ} Hz",
}  # fmt: skip
GENTLE = {"oscillator_mass": "3.8 kg", "damping_ratio": 0.007, "base_amplitude": "0.3 mm"}


def made_of(machine, name, value, within=(7.0, 9.0), depth=0, loose=None, **options):
    """A survey of one machine over its frequency, which begins without a word."""
    family = Family(machine, None, over="frequency", within=within, loose=loose)
    return survey(family, {name: [value]}, over="frequency", within=within, depth=depth, workers=1, **options)


def largest(machine, values, measure="max_abs_q1", **options):
    """The largest response of a sweep."""
    return max(row.measures[measure] for row in sweep(machine, "frequency", values, **options))


def slid(frequency):
    """Largest displacement [mm] of the oscillator while the absorber slides to and fro without a stop.

    M x'' = -k (x - e) - c (x' - e') - f S and m y'' = f S, S the sign of x' - y': over half a period, after which the mirror image follows, x is the
    answer to the base, H exp(i w t), and to a constant force, two exponentials. The half begins where x' is y', which is -f half / 2 m there.
    """
    w, omega, f = 2.0 * np.pi * HERTZ, 2.0 * np.pi * frequency, FRICTION * SMALL * G
    half = np.pi / omega
    t = np.linspace(0.0, half, 20_001)
    rates = w * (-ZETA + 1j * np.sqrt(1.0 - ZETA**2) * np.array([1.0, -1.0]))
    rest = -f / (M * w * w)
    weights = 2.0 * rest * rates[::-1] / np.diff(rates) * [-1.0, 1.0] / (1.0 + np.exp(rates * half))
    answer = rest + (weights * np.exp(np.multiply.outer(t, rates))).sum(axis=1).real
    speed = (weights * rates * np.exp(np.multiply.outer(t, rates))).sum(axis=1).real
    H = BASE * (w * w + 2j * ZETA * w * omega) / (w * w - omega**2 + 2j * ZETA * w * omega)
    slip = FRICTION * G * (t - 0.5 * half)  # y'
    angle = np.arccos((slip[0] - speed[0]) / (abs(H) * omega))
    found = [0.0]
    for phase in (angle, -angle):
        turning = np.exp(1j * (omega * t + phase))
        if np.all((speed + abs(H) * omega * turning.real > slip)[1:-1]):
            found.append(np.abs(answer + abs(H) * turning.imag).max())
    return 1e3 * max(found)


def test_the_sliding_motion_counts_where_the_walls_are_far():
    """Without a word the diagram begins with impacts, which reach 79.5 mm; sliding, stable everywhere, reaches more."""
    made = made_of(physical("coupled", CASE), "half_width", 110.0, depth=1)
    top = minimize_scalar(
        lambda hertz: -slid(hertz), bounds=(7.95, 8.05), method="bounded", options={"xatol": 1e-5}
    )
    assert 99.6 < -top.fun < 99.7
    assert made["peak"][0] == pytest.approx(-top.fun, rel=1e-8)
    assert made["peak_at"][0] == pytest.approx(top.x, abs=1e-4)
    assert made["covered"][0] == 1.0 and made.notes[0] == ""


@pytest.mark.parametrize("number", [0, 4])
def test_drawn_machines_have_the_peaks_of_simulations(number):
    found = judged(number, drawn(number, 2), depth=1, values=61)
    assert not any(verdict.wrong for verdict in found)
    assert any(not verdict.note for verdict in found)


def test_a_chaotic_response_is_known_where_it_is_simulated():
    """About its peak no motion that is stable is periodic; the largest response is that of a sweep."""
    machine = physical(
        "coupled", CASE | GENTLE | {"half_width": "8 mm", "restitution": 0.689, "friction": 0.087}
    )
    made = made_of(machine, "half_width", 8.0, outcomes=("peak", "lower_peak"))
    swept = largest(machine, np.linspace(7.94, 7.98, 21))
    assert made["covered"][0] >= 0.999 and "chaotic" in made.notes[0]
    assert made["peak"][0] == pytest.approx(swept, rel=0.02)  # what is seen of chaos settles to a hundredth
    assert made["lower_peak"][0] == pytest.approx(swept, rel=0.02)  # where it is largest nothing coexists
    assert made.best("peak") == ({"half_width": 8.0}, made["peak"][0])


@pytest.mark.parametrize(
    ("width", "changes", "depth", "values", "accuracy"),
    [
        (
            12.0,
            GENTLE | {"restitution": 0.6634379, "friction": 0.2661425},
            2,
            np.linspace(7.94, 7.97, 13),
            0.005,
        ),
        (
            175.0,
            {"slope": "10 deg", "restitution": 0.7, "friction": 0.155},
            0,
            np.linspace(8.2, 8.08, 49),
            0.03,
        ),
    ],
    ids=["chaotic", "modulated"],
)
def test_a_motion_without_a_period_is_followed_to_where_it_is_largest(
    width, changes, depth, values, accuracy
):
    """What follows a cascade from the left and one from the right is alike; the response is a fifteenth larger half-way. In an inclined cavity,
    right of the resonance, the motion without a period coexists with a branch, and is larger where no start led to it."""
    machine = physical("coupled", CASE | changes | {"half_width": f"{width} mm"})
    made = made_of(machine, "half_width", width, depth=depth)
    assert made["peak"][0] == pytest.approx(largest(machine, values), rel=accuracy)


@pytest.mark.long
def test_a_large_chaotic_motion_beside_a_stable_one_is_followed_to_where_it_is_largest():
    """Two absorbers: a slow sweep downwards from 8.01 Hz meets it, and keeps it for 2000 periods; starts at these frequencies lead to the small
    motion that coexists. Further down it is a transient."""
    case = {"clearance_1": 30.0}
    made = made_of(coupled_two, "restitution_1", 0.6, loose=case)
    swept = largest(coupled_two, np.linspace(8.01, 7.996, 8), "max_abs_q", transient=2000, **case)
    # a chaotic motion's largest is that of a finite run
    assert made["peak"][0] == pytest.approx(swept, rel=0.05)
    assert made["covered"][0] >= 0.999 and "chaotic" in made.notes[0]


def test_a_completion_whose_budget_is_spent_says_so_and_answers_by_simulation():
    machine = physical("coupled", CASE | {"half_width": "60 mm", "restitution": 0.7, "friction": 0.155})
    made = made_of(machine, "half_width", 60.0, (7.5, 8.5), settings={"completion": 1})
    grid = np.linspace(7.7, 8.3, 121)
    swept = max(largest(machine, grid), largest(machine, grid[::-1]))
    assert "completion = 1 is spent: " in made.notes[0]
    assert "motions that were met have no branch" in made.notes[0]
    assert made["peak"][0] == pytest.approx(swept, rel=0.01) or made["covered"][0] < 0.999


def test_gaps_are_seen_where_values_are_near_enough():
    """A fortieth of the interval [0, 10] is 0.25: 3.1 is too far from 2.8 and from 3.5, 6 has no value in its gap."""
    open_ = [(1.0, 1.5), (2.6, 3.5), (5.0, 6.0)]
    assert not_simulated(open_, (0.0, 10.0), [1.25, 2.8, 3.1, 4.0]) == [(2.8, 3.1), (3.1, 3.5), (5.0, 6.0)]
    assert not_simulated(open_, (0.0, 10.0), []) == open_


def test_gaps_of_a_thousandth_are_not_simulated():
    assert spread([(1.0, 1.004), (2.0, 2.005)], (0.0, 10.0), 5) == []
    places = spread([(1.0, 1.004), (2.0, 2.005), (3.0, 3.002)], (0.0, 10.0), 5)
    assert places and all(2.0 < p < 2.005 for p in places)


def flowing(values, near):
    """u' = u^2 + p^2 - r^2, whose equilibria are a circle."""
    return cv.AlgebraicProblem(
        lambda u, p: u**2 + p**2 - values["radius"] ** 2, [-values["radius"]], 0.0, spectrum="flow"
    )


def test_what_is_not_known_is_said_and_never_the_best():
    """Of a circle u^2 + p^2 = r^2 the lower half is stable: 2 r of the 6 that p runs over."""
    made = survey(flowing, {"radius": [1.0, 2.0, 3.0]}, over="p", within=(-3.0, 3.0), workers=1)
    assert made["covered"] == pytest.approx([1.0 / 3.0, 2.0 / 3.0, 1.0])
    assert [bool(note) for note in made.notes] == [True, True, False]
    assert "66.7 %" in made.notes[0] and (made.failed, made.partly) == (0, 2)
    assert (
        made.best("peak")
        == made.best("peak", largest=True)
        == ({"radius": 3.0}, pytest.approx(made["peak"][2]))
    )
    assert np.isfinite(made.known("peak", covered=0.6)).tolist() == [False, True, True]
    with pytest.raises(PlanError, match="peak is known of no system"):
        survey(flowing, {"radius": [1.0]}, over="p", within=(-3.0, 3.0), workers=1).best("peak")


def test_stability_that_is_not_computed_is_no_gap():
    made = survey(Circles(), {"radius": [1.0]}, over="p", within=(-3.0, 3.0), workers=1)
    assert np.isnan(made["covered"][0]) and np.isnan(made["peak"][0]) and made.notes[0] == ""
