"""Random excitation: the variance of linear oscillators in closed form, the stationary density before an elastic wall, a rigid one, seeds."""

import numpy as np
import pytest

from orbits import Coupled, Machine, ParameterError, Switch
from orbits.design.random_excitation import Density, random_base, random_page, transfer

MACHINE = Coupled(damping=2.0, mass_ratio=0.02, restitution=0.6, friction=0.05, gravity=0.3)
PARAMS = MACHINE.vector({"forcing": 0.0, "frequency": 1.0})
FLAT = Density(np.array([0.2, 2.0]), np.array([0.1, 0.1]))


def white(d, top):
    """E[xi xi'] = 2 d delta: one-sided, per radian, 2 d / pi."""
    return Density(np.array([0.0, top]), np.full(2, 2.0 * d / np.pi))


def test_the_bare_and_the_tuned_machine_have_their_variances():
    """Quadrature of |H|^2 S; H of the tuned one by a linear system of two masses. The density of the absorber's machine integrates to its variance."""
    seen = random_base(MACHINE, PARAMS, FLAT, periods=500, records=3)
    omega = np.linspace(0.2, 2.0, 40_001)
    f, zeta = 1.0 / 1.02, np.sqrt(3 * 0.02 / (8 * 1.02**3))  # Den Hartog
    link = 0.02 * (f * f + 2j * zeta * omega)
    bare = 1.0 / (1.0 - omega**2 + 0.04j * omega)
    matrices = np.array([[1 / bare + link, -link], [-link, link - 0.02 * omega**2]]).transpose(2, 0, 1)
    tuned = np.linalg.solve(matrices, np.array([[-1.0], [-0.02]]))[:, 0, 0]
    for name, response in (("bare", bare), ("tuned", tuned)):
        expected = np.sqrt(np.trapezoid(0.1 * np.abs(response) ** 2, omega))
        assert seen.numbers[f"rms_{name}"][0] == pytest.approx(expected, rel=2e-3)
    np.testing.assert_allclose(transfer(omega, 0.04, 0.0), -bare)
    area = seen.densities["oscillator"].sum() * (seen.omega[1] - seen.omega[0])
    assert np.sqrt(area) == pytest.approx(seen.numbers["rms_oscillator"][0], rel=0.02)


def test_the_march_of_a_machine_whose_absorber_hardly_weighs_is_the_bare_one():
    """Walls out of reach, no friction: the oscillator of the native march has the closed form's variance."""
    light = Coupled(damping=4e4, mass_ratio=1e-6, restitution=0.6, friction=0.0, gravity=0.0)
    params = light.vector({"forcing": 0.0, "frequency": 1.0})
    seen = random_base(light, params, FLAT, periods=300, records=2)
    mean, error = seen.numbers["rms_oscillator"]
    assert mean == pytest.approx(seen.numbers["rms_bare"][0], rel=2e-3) and error < 2e-3


def test_the_same_seed_is_the_same_motion():
    runs = [random_base(MACHINE, PARAMS, FLAT, periods=100, records=2, seed=seed) for seed in (5, 5, 6)]
    assert runs[0].numbers == runs[1].numbers != runs[2].numbers


@pytest.mark.slow
def test_before_an_elastic_wall_the_density_is_exponential_in_the_energy():
    """x'' + 2 zeta x' + V'(x) = xi has the stationary density exp(-2 zeta E / D), E = x'^2/2 + V, of Fokker and Planck's equation."""
    zeta, d, k, gap = 0.1, 0.05, 20.0, 0.5
    stop = Machine(
        name="stop", states=("x", "v"), parameters={"zeta": zeta, "k": k, "gap": gap, "base": 0.0},
        motion=lambda s, phase, p, c: (s.v, p.base - 2 * p.zeta * s.v - s.x - p.k * (s.x - p.gap) * (1 + c.stop) / 2),
        contacts=[Switch("stop", lambda s, phase, p: s.x - p.gap)],
    )  # fmt: skip
    seen = random_page(stop, stop.vector(), "base", white(d, 12.0), periods=1000, records=8, seed=3)
    x = np.linspace(-3.0, 2.0, 20_001)
    density = np.exp(-2 * zeta / d * (0.5 * x**2 + 0.5 * k * np.maximum(x - gap, 0.0) ** 2))
    density /= density.sum()
    mean = density @ x
    expected = {"mean_x": mean, "rms_x": np.sqrt(density @ (x - mean) ** 2), "rms_v": np.sqrt(d / (2 * zeta))}
    for name, true in expected.items():
        value, error = seen.numbers[name]
        assert abs(value - true) < 4.0 * error + 2e-3, name
    edges = np.linspace(-1.2, 0.7, 20)
    found = np.histogram(seen.samples["x"], edges)[0] / seen.samples["x"].size
    assert found == pytest.approx(np.histogram(x, edges, weights=density)[0], abs=0.012)


@pytest.mark.parametrize(
    ("frequencies", "densities", "slope", "options", "says"),
    [
        ([1.0], 1.0, 0.0, {}, "two rows or more"),
        ([2.0, 1.0], 1.0, 0.0, {}, "ascending"),
        ([1.0, 2.0], 0.0, 0.0, {}, "one is above 0"),
        ([1.0, 2.0], 1.0, 0.0, {"periods": 1e9}, "instants"),
        ([1.0, 2.0], 1.0, 0.0, {"records": 1}, "error bars need two"),
        ([1.0, 2.0], 1.0, 0.1, {}, "level cavities only"),
    ],
)
def test_what_cannot_be_is_refused(frequencies, densities, slope, options, says):
    machine, given = MACHINE.changed(slope=slope), np.array(frequencies)
    with pytest.raises(ParameterError, match=says):
        random_base(
            machine, machine.vector({"forcing": 0.0}), Density(given, 0.0 * given + densities), **options
        )
