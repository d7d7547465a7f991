"""The native kernels of cycles against the reference, on drawn nodes, words, parameters and machines."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from contvines.core.library import native
from orbits import arguments
from orbits.flows.native.cycle_equations import NativeEquations as Equations
from orbits.flows.native.cycle_equations import assemble
from orbits.flows.native.reference_kernels import ReferenceKernels
from orbits.machines.names import NAMES, NATIVE, usual
from orbits.machines.reference.machine import reference
from orbits.words import Word

pytestmark = pytest.mark.skipif(not native(), reason="no native core")

WORDS = ["LR", "LLR", "tt", "ss", "susu", "LRtt", "LRts", "LsuR", "LtR", "Lsu", "LR" * 5, "LR" * 20 + "L"]
MACHINES = {name: usual(name) for name in NAMES}


def test_all_machines_are_in_the_native_core():
    assert sorted(NATIVE) == sorted(NAMES)


def drawn(name, text, seed, symmetric, without_friction):
    """Equations, unknowns and the two sets of kernels; None where there are no such orbits."""
    model, given_ = MACHINES[name]
    draw = np.random.default_rng(seed)
    params = np.abs(model.vector(given_) * (1.0 + 0.2 * draw.normal(size=len(model.parameter_names))))
    if without_friction:
        params[[i for i, n in enumerate(model.parameter_names) if n.startswith("friction")]] = 0.0
    if symmetric and name == "cavity":  # level, with unlike distances of the walls
        for side in ("restitution", "friction"):
            params[model.parameter_names.index(f"{side}_right")] = params[
                model.parameter_names.index(f"{side}_left")
            ]
        params[model.parameter_names.index("slope")] = 0.0
    parameter = str(draw.choice(model.parameter_names))
    try:
        system = Equations(model, Word.parse(text), 1, parameter, params, symmetric)
    except ValueError:
        return None
    nodes = 0.5 * draw.normal(size=(system.length, model.node))
    nodes[:, 0] = draw.uniform(0.0, system.shift, system.length)
    if seed % 3:  # else durations of both signs, as on virtual branches
        nodes[:, 0].sort()
    return system, nodes.ravel(), assemble(model), ReferenceKernels(reference(name))


def close(one, other, tolerance=1e-12):
    one, other = np.asarray(one), np.asarray(other)
    np.testing.assert_array_equal(np.isfinite(one), np.isfinite(other))
    finite = np.isfinite(one)
    size = 1.0 + np.abs(other[finite]).max(initial=0.0)
    np.testing.assert_allclose(one[finite] / size, other[finite] / size, rtol=0.0, atol=tolerance)


cases = given(
    name=st.sampled_from(sorted(NAMES)),
    text=st.sampled_from(WORDS),
    seed=st.integers(0, 2**32 - 1),
    symmetric=st.booleans(),
)


@settings(max_examples=150, deadline=None)
@cases
def test_linearisation_elimination_and_margins(name, text, seed, symmetric):
    slides = not set(text) & set("tsu")  # turns are no events without friction
    known = drawn(name, text, seed, symmetric, slides and seed % 4 == 0)
    if known is None:
        return
    system, u, one, other = known
    p, works = system.began, (system.workspace(), system.workspace())
    data, draw = system.data, np.random.default_rng(seed)
    residuals = [k.linearise(data, u, p, work) for k, work in zip((one, other), works)]
    close(residuals[0], residuals[1])
    if not np.isfinite(residuals[0]):
        return
    for a, b in zip(works[0][:4], works[1][:4]):
        close(a, b)
    border = draw.normal(size=u.size + 1)
    (step, tangent), (own_step, own_tangent) = np.zeros((2, 2, u.size + 1))
    signs = (
        one.bordered(data, works[0], border, 0.3, step, tangent),
        other.bordered(data, works[1], border, 0.3, own_step, own_tangent),
    )
    if np.abs(own_step).max() < 1e4 and np.abs(own_tangent).max() < 1e4:  # else the matrix is nearly singular
        close(step, own_step, 1e-9)
        close(tangent, own_tangent, 1e-9)
        assert signs[0] == signs[1]
    rows = np.zeros((2, 2 * system.n_multipliers + system.n_margins))
    for k, work, row in zip((one, other), works, rows):
        k.inspect(data, u, p, work, row)
    count = 2 * system.n_multipliers
    close(rows[0, count:], rows[1, count:], 1e-9)
    if np.abs(rows[1, :count]).max() < 1e6:
        close(rows[0, :count].sum(), rows[1, :count].sum(), 1e-6)
    if symmetric and system.movable:
        return  # has no closure to turn round
    for k, work in zip((one, other), works):
        k.linearise(data, u, p, work)
        k.flip(data, work, -1.0)
    close(works[0].D, works[1].D)
    turned = system.workspace(), system.workspace()
    for k, work, target in zip((one, other), works, turned):
        k.transpose(data, work, border[:-1], target)
    for a, b in zip(turned[0][1:4], turned[1][1:4]):
        close(a, b)


@settings(max_examples=25, deadline=None)
@given(st.integers(0, 2**32 - 1))
def test_numbers_that_follow_powers_of_amounts(seed):
    """`assign` and the path of a machine with a law, as physical machines have."""
    draw = np.random.default_rng(seed)
    count, powers = 6, draw.choice([-2.0, -1.0, -0.5, 0.0, 0.5, 1.0, 2.0, 1.3], size=(4, 6))
    law = np.vstack([draw.uniform(0.5, 2.0, count), powers])
    amounts = draw.uniform(0.5, 2.0, 4)

    def data(active):
        params = law[0] * np.prod(amounts[:, None] ** powers, axis=0)
        path = np.array([params / amounts[active] ** powers[active], powers[active]])
        return arguments.cycle_data([0], [1], params, path, 1.0, 6.0, 0, active, amounts, law)

    value, kernels = float(draw.uniform(0.5, 2.0)), assemble(MACHINES["absorber"][0])
    first, other = data(0), data(2)
    kernels.assign(first, other, value)
    again = data(0)
    ReferenceKernels.assign(again, other, value)
    for one, two in ((first.params, again.params), (first.path, again.path), (first.amounts, again.amounts)):
        np.testing.assert_allclose(one, two, rtol=1e-14)


def test_newton_finds_what_the_reference_finds():
    model, given_ = MACHINES["absorber"]
    params = model.vector(given_)
    system = Equations(model, Word.parse("LR"), 1, "amplitude", params, False)
    guess = system.reduce(next(model.start_nodes(Word.parse("LR"), 1, params))) + 0.03
    found = []
    for kernels in (assemble(MACHINES["absorber"][0]), ReferenceKernels(reference("absorber"))):
        u, border = guess.copy(), np.zeros(system.dimension + 1)
        border[-1] = 1.0
        work, step, tangent = system.workspace(), np.zeros_like(border), np.zeros_like(border)
        residual, _, p = kernels.newton(system.data, u, system.began, work, border, step, tangent, 1e-12, 40)
        assert residual < 1e-13 and p == system.began
        found.append(u)
    np.testing.assert_allclose(found[0], found[1], atol=1e-12)
