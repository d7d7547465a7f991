"""Lines to compare a graph with, and numbers as people read them."""

import matplotlib.pyplot as plt
import numpy as np
import pytest

import contvines as cv
from contvines.command.compose import first_orbit, machine
from contvines.command.plot import draw_compared, peaks_compared
from contvines.command.study import check_study, read_study
from tests.contvines.studies import EXAMPLES, SI, data


def test_the_bare_oscillator_of_a_shaken_base_in_millimetres():
    """Shaken at its base by 1 mm: |1 + 2 i zeta r| / |1 - r^2 + 2 i zeta r| millimetres, r the frequency over 8 Hz."""
    shaken = 'model.damping_ratio = 0.02\nmodel.base_amplitude = "1 mm"\nmodel.friction = 0.5'
    place = 'start = { word = "", frequency = "3 Hz" }\ncontinue.within = ["2.9 Hz", "3.1 Hz"]'
    orbit = first_orbit(check_study(data(SI, f"{shaken}\n{place}")))
    graph = cv.diagram(orbit, over="frequency", within=(2.9, 3.1), depth=0)
    figure, axes = plt.subplots()
    draw_compared(axes, graph, ["bare"], None, "max_abs_q1")
    values, response = axes.lines[0].get_data()
    plt.close(figure)
    r = np.asarray(values) / 8.0
    np.testing.assert_allclose(response, np.abs((1 + 0.04j * r) / (1 - r**2 + 0.04j * r)), rtol=0.02)
    assert values[0] == 2.9 and values[-1] == 3.1


def test_peaks_to_compare_with_are_those_of_two_oscillators_in_the_frequency_domain():
    """The bare oscillator on its shaken base, and Den Hartog's absorber on it: tuned to f_0/(1 + mu), c = 2 m omega_0 sqrt(3 mu/(8 (1 + mu)^3))."""
    model = machine(read_study(EXAMPLES / "design" / "absorber.toml"))
    r, zeta, mu = np.linspace(7.0, 9.0, 400_001) / 8.0, 0.007, 0.032 / 3.8
    load = 0.3 * (1.0 + 2j * zeta * r)  # mm, over the oscillator's stiffness
    own = 1.0 - r**2 + 2j * zeta * r
    link = mu * (1.0 / (1.0 + mu) ** 2 + 2j * r * np.sqrt(3.0 * mu / (8.0 * (1.0 + mu) ** 3)))
    wanted = {"bare": np.abs(load / own), "tuned": np.abs(load / (own + link - link**2 / (link - mu * r**2)))}
    for kind, (peak, at) in peaks_compared(model, "frequency", (7.0, 9.0), list(wanted)).items():
        assert peak == pytest.approx(wanted[kind].max(), rel=1e-9)
        assert at == pytest.approx(8.0 * r[wanted[kind].argmax()], abs=1e-5)
