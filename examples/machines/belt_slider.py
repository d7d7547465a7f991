"""A slider on a moving belt: friction that weakens with the sliding speed drives stick-slip oscillations."""

from orbits import DryFriction, Machine


def weakening(state, phase, p):
    sliding = p.belt - state.v  # speed of the belt under the slider
    return p.least + (p.most - p.least) / (1 + p.weakening * sliding**2)


machine = Machine(
    name="belt_slider",
    states=("x", "v"),
    parameters={"belt": 0.5, "damping": 0.05, "most": 1.0, "least": 0.5, "weakening": 4.0},
    motion=lambda state, phase, p, contact: (state.v, -state.x - 2 * p.damping * state.v + contact.belt),
    contacts=[DryFriction("belt", velocity=lambda state, phase, p: state.v - p.belt, limit=weakening)],
)
