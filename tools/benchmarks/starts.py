"""Time of many starts at once: a batch of starts with 200 impacts each, compared with the plain simulator for the same flights."""

import numpy as np

from orbits import Absorber
from orbits.flows.native.batches import Settling
from orbits.flows.native.simulator import skip
from orbits.machines.native_stepper import stepper as machine
from orbits.machines.stepping import PSI, RATE, TURNS, V, W

PERIODS = 100  # forcing periods of a start at amplitude 0.6, where the motion hits twice in each: 200 impacts
AMPLITUDE = 0.6


class Starts:
    """Starts of the paper's absorber, simulated for 100 periods in one batch or one by one, and a basin picture with as many starts."""

    def __init__(self, count=2000):
        model = Absorber(restitution=0.76, friction=0.5, gravity=0.211, mass_ratio=0.006)
        self.population = model.population("amplitude")
        self.population.workers = 1
        self.params = model.vector_at("amplitude", AMPLITUDE, {})
        self.engine = machine(model.name)
        self.drawn = self.population.starts(count, 0, AMPLITUDE)
        self.states = np.zeros((count, self.engine.state))
        self.states[:, [PSI, W, RATE]] = self.drawn

    def batch(self):
        """Simulate all starts in one compiled loop; return the final states, shape (n, S)."""
        states, n = self.states.copy(), len(self.states)
        found = {name: np.zeros(n, np.int64) for name in ("periods", "impacts", "holds", "outcome")}
        found["gaps"] = np.full(n, np.inf)
        # with distance 0 no start counts as settled, so every start is simulated to the end
        Settling(self.engine, self.params, PERIODS - 1.0, 1, 0.0).settle(states, found)
        return states

    def plain(self):
        """Simulate the starts one by one with the plain simulator."""
        states = self.states.copy()
        for state in states:
            self.engine.launch(state, self.params)
            until = np.floor(state[TURNS] + state[PSI] / (2.0 * np.pi) + 0.5) + PERIODS
            skip(self.engine, state, self.params, until, 100 * PERIODS)
        return states

    def basin(self):
        """Compute a basin picture with as many starts."""
        import contvines

        side = int(np.sqrt(len(self.states)))
        return contvines.basins(self.population, at=AMPLITUDE, points=side)

    def census(self):
        """Find the attractors of as many random starts."""
        side = int(np.sqrt(len(self.states)))
        return self.population.settle(self.drawn[: side * side], AMPLITUDE)


def places(states):
    """Return the states without phase: w, w', and v, v' of the coupled machine."""
    return states[:, [W, RATE, *range(V, states.shape[1])]]
