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
    numbers = dict(zip(model.parameter_names, params))
    if without_friction:
        numbers |= {key: 0.0 for key in numbers if key.startswith("friction")}
    if symmetric and name == "cavity":  # level, with unlike distances of the walls
        numbers |= {f"{key}_right": numbers[f"{key}_left"] for key in ("restitution", "friction")}
        numbers["slope"] = 0.0
    parameter, params = str(draw.choice(model.parameter_names)), np.array([*numbers.values()])
    try:
        system = Equations(model, Word.parse(text), 1, parameter, params, symmetric)
    except ValueError:
        return None
    nodes = 0.5 * draw.normal(size=(system.length, model.node))
    nodes[:, 0] = draw.uniform(0.0, system.shift, system.length)
    if seed % 3:  # else durations of both signs, as on virtual branches
        nodes[:, 0].sort()
    return system, nodes.ravel(), assemble(model), ReferenceKernels(reference(name))


def told(kernels, system, u, border):
    """What kernels say of a system: residual and derivatives, the bordered solution, multipliers and margins, the closure turned round."""
    data, p, work = system.data, system.began, system.workspace()
    residual = kernels.linearise(data, u, p, work)
    parts = [residual, *(part.copy() for part in work[:4])]
    solution, row = np.zeros((2, len(border))), np.zeros(2 * system.n_multipliers + system.n_margins)
    sign = kernels.bordered(data, work, border, 0.3, *solution)
    kernels.inspect(data, u, p, work, row)
    kernels.linearise(data, u, p, work)
    if not (system.symmetric and system.movable):  # it has no closure to turn round
        kernels.flip(data, work, -1.0)
    return parts, solution, sign, row, work.D


def close(one, other, tolerance=1e-12):
    one, other = np.asarray(one), np.asarray(other)
    np.testing.assert_array_equal(np.isfinite(one), np.isfinite(other))
    finite = np.isfinite(one)
    size = 1.0 + np.abs(other[finite]).max(initial=0.0)
    np.testing.assert_allclose(one[finite] / size, other[finite] / size, rtol=0.0, atol=tolerance)


@settings(max_examples=150, deadline=None)
@given(st.sampled_from(sorted(NAMES)), st.sampled_from(WORDS), st.integers(0, 2**32 - 1), st.booleans())
def test_linearisation_elimination_and_margins(name, text, seed, symmetric):
    slides = not set(text) & set("tsu")  # turns are no events without friction
    known = drawn(name, text, seed, symmetric, slides and seed % 4 == 0)
    if known is None:
        return
    system, u, *kernels = known
    border = np.random.default_rng(seed).normal(size=u.size + 1)
    one, other = (told(each, system, u, border) for each in kernels)
    for a, b in zip(one[0], other[0]):
        close(a, b)
        if not np.isfinite(b).all():
            return
    if np.abs(other[1]).max() < 1e4:  # else the matrix is nearly singular
        close(one[1], other[1], 1e-9)
        assert one[2] == other[2]
    count = 2 * system.n_multipliers
    close(one[3][count:], other[3][count:], 1e-9)
    if np.abs(other[3][:count]).max() < 1e6:
        close(one[3][:count].sum(), other[3][:count].sum(), 1e-6)
    close(one[4], other[4])


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
