"""Every part of the benchmarks runs, and all programs compute the same branch. Times are not tested."""

import numpy as np
import pytest

from tools.benchmarks import case, figures, flows, run, scripts
from tools.benchmarks.auto import Auto
from tools.benchmarks.flights import MODELS, Flights
from tools.benchmarks.floor import FORWARD, ORTHOGONAL, PLAIN, VECTOR, Floor, library
from tools.benchmarks.loci import WITHIN, Loci
from tools.benchmarks.ours import Core, PublicAPI
from tools.benchmarks.starts import Starts, places

pytestmark = pytest.mark.slow

needs_compiler = pytest.mark.skipif(library() is None, reason="no C compiler")


def exact_amplitude(u):
    """Amplitude of the symmetric orbit as a closed form of the speed after its first impact."""
    r, mu, g, eps, omega = case.PARAMS[1:]
    beta = (u[..., 1] - 0.5 * np.pi * (1.0 + eps) * mu * g / omega) / omega
    C = [case.symmetric_orbit(b)[2] for b in np.atleast_1d(beta)]
    return np.array(C)


@needs_compiler
@pytest.mark.parametrize("l", [2, 8, 64])
@pytest.mark.parametrize(("eliminate", "flags"), [(FORWARD, PLAIN), (ORTHOGONAL, PLAIN), (FORWARD, VECTOR)])
def test_floor_and_loop_take_the_same_steps(l, eliminate, flags):
    floor, core = Floor(l, eliminate, flags, 200).result(), Core(l, 200).result()
    assert len(floor.values) == len(core.values) == 200
    np.testing.assert_allclose(floor.values, core.values, atol=1e-9)
    np.testing.assert_allclose(floor.points, core.points, atol=1e-8)
    np.testing.assert_allclose(floor.values, exact_amplitude(floor.points), atol=1e-11)
    margins = np.isfinite(floor.rows[1:]) & np.isfinite(core.rows[1:])
    assert margins[:, :4].all() and np.array_equal(np.isfinite(floor.rows[1:]), np.isfinite(core.rows[1:]))
    np.testing.assert_allclose(floor.rows[1:][margins], core.rows[1:][margins], atol=1e-6)
    assert floor.sweeps <= 3 * floor.tried


def test_scripts_find_the_branch():
    for script in (scripts.dense, scripts.sparse):
        amplitudes, spectra = script(8, 20)
        expected = np.array([case.start(8)[1], *Core(8, 40).result().values[1:]])
        assert np.all(np.diff(amplitudes) > 0.0) and amplitudes[-1] < expected[-1] + 0.01
        assert np.all(np.abs(spectra) < 1.0)
    amplitudes, _ = scripts.by_fsolve(2, 5)
    assert len(amplitudes) == 6


def test_public_api_follows_both_directions():
    api = PublicAPI(2)
    points = api.run()
    (branch,) = api.graph
    assert points == len(branch.values)
    np.testing.assert_allclose(branch.values, exact_amplitude(branch.points), atol=1e-10)


def test_whole_diagram_has_what_the_example_says():
    table, sizes = run.whole_diagrams(1, ("friction",))
    assert sizes["friction"].startswith("13 branches, 23 special points, ")
    assert all(row["friction"] > 0.0 for row in table.values())


@pytest.mark.parametrize("name", MODELS)
def test_simulations_agree(name):
    flights = Flights(name)
    phases, speeds = flights.ours(30)
    for found in (flights.floor(30), flights.solve_ivp(6)):
        if found is not None:
            n = len(found[0])
            assert n in (6, 30)
            np.testing.assert_allclose(found[0], phases[:n], atol=1e-6)
            np.testing.assert_allclose(found[1], speeds[:n], atol=1e-6)


def test_a_batch_goes_where_the_plain_simulator_goes():
    starts = Starts(64)
    one, other = places(starts.batch()), places(starts.plain())
    np.testing.assert_allclose(one, other, atol=1e-6)
    shares = {about.name: about.share for about in starts.basin().attractors}
    assert set(shares) >= {"LR"} and sum(shares.values()) == pytest.approx(1.0)
    times = run.many_starts(1, 16)
    assert list(times) == ["one batch", "one by one", "basin", "census"] and min(times.values()) > 0.0


@pytest.mark.parametrize("times", [1, 17])
def test_folds_of_words_written_many_times_are_their_closed_form(times):
    r, _, g, eps, omega = case.PARAMS[1:]
    fold = Loci(times, "symmetric").locus("fold", 20.0)
    R, b = (1.0 - r) / (1.0 + r), 0.5 * np.pi
    for amplitude, friction in fold.values:  # C^2 = (1 - pi beta/2)^2 + (R beta + H)^2 is least
        H = 0.5 * np.pi * (1.0 + eps) * friction * g / omega**2
        assert amplitude == pytest.approx((R + b * H) / np.hypot(R, b), abs=1e-11)
    assert fold.branch.range == pytest.approx(WITHIN)


def test_loci_of_a_word_written_17_times_are_those_of_the_word():
    once, many = Loci(1, "asymmetric"), Loci(17, "asymmetric")
    for kind in once.starts:
        found = [runs.locus(kind, 40.0).at(0.3) for runs in (once, many)]
        assert len(found[0]) == 1 and found[1] == pytest.approx(found[0], abs=1e-10)


@needs_compiler
def test_figures_are_positive():
    assert set(figures.simulations(1, 200)) == set(MODELS) == set(figures.SIMULATED)
    assert figures.second_diagram(1) > 0.0


def test_ratios_of_loci_are_counted():
    seconds, times, exponents = run.ratios(1, (1,))
    assert set(seconds) == set(times) == {"fold", "period-doubling", "velocity-graze"} and not exponents


def test_auto_where_it_is_installed():
    auto = Auto()
    if not auto.available:
        pytest.skip("AUTO-07p is not installed")
    _, rows = auto.run(2, 10)
    assert len(rows) == 10 and float(rows[0][4]) == pytest.approx(case.start(2)[1], rel=1e-9)


def test_tables_print(capsys):
    run.show(
        "title",
        ["a", "b"],
        [1, 2],
        lambda name, column: run.number(None if name == "a" else 1.23456 * column),
    )
    assert "1.23" in capsys.readouterr().out and run.machine()
    seconds, slopes = run.growth(1, (2, 4))
    assert set(seconds) == {2, 4} and len(slopes) == 1


def test_cycles_of_flows_reach_the_same_end():
    """Parameter and period at the end of the branch agree between all programs that are installed."""
    ends = {}
    for name, competitor in flows.competitors(40).items():
        _, points = competitor.run()
        if name == "AUTO":
            ends[name] = float(points[-1][4])
            continue
        ends[name] = points[-1].value
        orbit = competitor.problem.orbit(points[-1].u, points[-1].value)
        assert orbit.replay() < 1e-4
        assert np.allclose(points[-1].multipliers[:1], orbit.multipliers[:1], rtol=1e-6)
    assert all(abs(end - flows.END) < 1e-4 for end in ends.values())
