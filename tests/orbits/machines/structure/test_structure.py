"""Structures: linear responses solved directly, the coupled machine, files, refusals."""

import pickle

import numpy as np
import pytest
from scipy.io import savemat

from orbits import Coupled, ParameterError, structure
from orbits.design.page_transients import page_transient
from orbits.problem import rebuild
from tests.machines import STRONG
from tests.orbits.machines.coupled.bodies import nodes_of_bodies


def chain(n, damping=0.02):
    k = 2.0 * np.eye(n) - np.eye(n, k=1) - np.eye(n, k=-1)
    return np.eye(n), damping * k, k


@pytest.mark.slow
def test_a_long_chain_is_reduced_with_the_error_that_it_says():
    m, c, k = chain(40, damping=0.3)
    wall = {"at": 30, "gap": 1e6, "restitution": 0.7}
    machine = structure(m, c, k, forces=[{"at": 7, "amplitude": 1.0}], walls=[wall], frequency=0.11)
    small = machine.reduction
    assert len(small.mass) < 20 and small.size == 40 and 0.0 < small.error <= 0.01
    worst = 0.0
    for omega in np.linspace(0.01, 0.55, 501):
        whole, less = (
            np.linalg.inv(kk + 1j * omega * cc - omega**2 * mm)
            for mm, cc, kk in ((m, c, k), (small.mass, small.damping, small.stiffness))
        )
        true = whole[np.ix_([6, 29], [6, 29])]
        worst = max(worst, np.linalg.norm(less[:2, :2] - true) / np.linalg.norm(true))
    assert worst <= 1.05 * small.error
    orbit = machine.attractor({}).found
    amplitude = abs(np.linalg.solve(k + 0.11j * c - 0.11**2 * m, np.eye(40)[6])[29])
    assert orbit.measure("max_x30") == pytest.approx(amplitude, rel=0.01)


def test_an_absorber_on_one_mass_is_the_coupled_machine():
    """M = 1, K = 1, C = eps lambda, a force of eps G with the damper's share left out; the absorber weighs eps."""
    values = {**STRONG, "damping": 1.0, "forcing": 2.47, "frequency": 1.01, "excitation": "truncated"}
    known, eps = Coupled(**values).symmetric_orbit(), STRONG["mass_ratio"]
    limit = STRONG["friction"] * STRONG["gravity"] * eps
    machine = structure(
        [[1.0]], [[eps]], [[1.0]], frequency=1.01,
        forces=[{"at": 1, "amplitude": eps * 2.47, "shift": -np.pi / 2}],
        absorbers=[{"at": 1, "mass": eps, "clearance": 1.0, "restitution": STRONG["restitution"], "friction": limit}],
    )  # fmt: skip
    nodes = nodes_of_bodies(known)
    orbit = machine.orbit("L1 R1", 1, nodes)
    np.testing.assert_allclose(orbit.nodes, nodes, atol=1e-9)
    np.testing.assert_allclose(
        sorted(map(abs, orbit.multipliers)), sorted(map(abs, known.multipliers)), atol=1e-8
    )
    assert orbit.measure("impulse") == pytest.approx(eps * known.measure("impulse"), rel=1e-8)


def moving(walls, start, time, limit=0.0, forces=(), size=1):
    """A motion from a start, without damping."""
    m, _, k = chain(size) if size > 1 else (np.eye(1), None, np.eye(1))
    frictions = [{"at": 1, "to": 2, "limit": limit}] if limit else []
    machine = structure(m, 0.0 * m, k, walls=walls, frictions=frictions, forces=[*forces])
    return page_transient(machine, machine.vector(), start, time=time)


def test_contacts_between_degrees_of_freedom_and_their_balance():
    """A rigid wall and dry friction between two masses, unforced: what they take is what the energy loses."""
    wall = {"at": 1, "to": 2, "gap": 0.1, "restitution": 0.8}
    seen = moving([wall], {"x1": 0.0, "x2": 1.0}, 12.0, limit=0.02, size=2)
    assert seen.impact_times.size > 2
    assert seen.impacts[-1] + seen.friction[-1] == pytest.approx(seen.energy[0] - seen.energy[-1], rel=1e-9)


def test_an_elastic_wall_stores_what_the_masses_lose():
    """Without damping the energy stays; at the turning point 1/2 k (x - gap)^2 + 1/2 x^2 is that of the start."""
    wall = {"at": 1, "gap": 0.5, "stiffness": 9.0}
    run = moving([wall], {"x1": 0.0, "v1": 1.0}, 20.0, forces=[{"at": 1, "amplitude": 0.0}])
    assert run.energy == pytest.approx(np.full(len(run.times), 0.5), rel=1e-9)
    # 9/2 (x - 1/2)^2 + x^2/2 = 1/2 at the turn: 10 x^2 - 9 x + 5/4 = 0
    assert run.states["x1"].max() == pytest.approx((9.0 + np.sqrt(81.0 - 50.0)) / 20.0, rel=1e-3)


def test_files(tmp_path):
    m, c, k = chain(3)
    savemat(tmp_path / "all.mat", {"M": m, "K": k})
    np.savetxt(tmp_path / "c.csv", c, delimiter=",")
    np.savetxt(tmp_path / "k.txt", k)
    first, second = (
        structure("all.mat:M", "c.csv", file, forces=[{"at": 1, "amplitude": 1.0}], folder=tmp_path)
        for file in ("all.mat:K", "k.txt")
    )
    for made in (first, second):
        np.testing.assert_allclose(made.reduction.stiffness, k)
        np.testing.assert_allclose(made.reduction.damping, c)
    again = pickle.loads(pickle.dumps(first))
    assert again.states == first.states and again.parameters == first.parameters
    problem = first.attractor({}).found.problem("frequency")
    assert rebuild(problem.describe()).model.settings() == first.settings()


ONE = [[1.0]]


def refused(matrices=(ONE, ONE, ONE), **contacts):
    """What a structure is made of: matrices, and one entry of each list."""
    return matrices, {name: [entry] for name, entry in contacts.items()}


REFUSED = {
    "its shape is": refused(([[1.0, 2.0]], ONE, ONE)),
    "not positive definite": refused(([[0.0]], ONE, ONE), forces={"at": 1, "amplitude": 1.0}),
    "not symmetric": refused((np.eye(2), np.eye(2), [[1.0, 2.0], [0.0, 1.0]])),
    "has 1 degrees of freedom, mass has 2": refused((np.eye(2), ONE, np.eye(2))),
    "cannot be read": refused((ONE, ONE, "nowhere.csv")),
    "without forces and contacts": refused(),
    "at = 2 is no degree of freedom; expected 1 to 1": refused(forces={"at": 2, "amplitude": 1.0}),
    "amplitude is missing": refused(forces={"at": 1}),
    "did you mean 'amplitude'": refused(forces={"at": 1, "amplitud": 1.0}),
    "restitution, of a rigid wall, or stiffness": refused(walls={"at": 1, "gap": 1.0}),
    "at and to are both 1": refused(walls={"at": 1, "to": 1, "gap": 1.0, "stiffness": 1.0}),
    "stiffness = -1 is out of range": refused(walls={"at": 1, "gap": 1.0, "stiffness": -1.0}),
}


@pytest.mark.parametrize("says", REFUSED)
def test_what_is_no_structure_is_refused(says):
    matrices, contacts = REFUSED[says]
    with pytest.raises(ParameterError, match=says):
        structure(*matrices, **contacts)
