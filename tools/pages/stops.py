"""Long simulation of a mass with dry friction between two stops, which it must not penetrate.

`python -m tools.pages.stops [IMPACTS]` simulates a million impacts by default and prints the largest penetration of a
stop: at events, and at extrema of the displacement inside flights, located as roots of the velocity in the steps.
"""

import sys
import time

import numpy as np

from orbits.contacts import HIT
from orbits.flows.page.stepper import Stepper
from orbits.symbols import sin
from tests.orbits.declared.oscillators import FLOOR, LEFT, RIGHT, oscillator


def farthest(impacts: int, forcing: float = 5.0, frequency: float = 1.1) -> tuple[float, int]:
    """Return the largest |x| and the number of events in a simulation with this number of impacts between stops at -1 and 1."""
    machine = oscillator(
        lambda s, phase, p, contact: forcing * sin(phase) + contact.floor, RIGHT, LEFT, FLOOR,
        parameters={"frequency": frequency, "friction": 0.3, "restitution": 0.7, "gap": 1.0},
    )  # fmt: skip
    stepper = Stepper(machine, machine.vector())
    stepper.start(np.array([0.3, 0.1]), 0.0)
    e, far, hits, events = machine.equations, 0.0, 0, 0
    numbers, watches = {}, {}
    while hits < impacts:
        modes, state, begin = stepper.modes, stepper.state.copy(), stepper.base + stepper.clock
        start = stepper.clock
        event = stepper.advance(begin + 1e3)
        if event is None:
            continue
        if modes not in watches:
            watches[modes] = machine.compiled.extremes(e.pattern_key(modes))
            numbers[modes] = machine.compiled.numbers(stepper.params, modes)
        end = start + stepper.base + stepper.clock - begin
        inside = watches[modes](state, start, end, numbers[modes])
        far = max(far, abs(float(stepper.state[0])), *(abs(float(x[0])) for _, _, x in inside), 0.0)
        hits += event[1] == HIT
        events += 1
    return far, events


def main() -> None:
    """Print the largest excess."""
    impacts = int(sys.argv[1]) if len(sys.argv) > 1 else 1_000_000
    began = time.process_time()
    far, events = farthest(impacts)
    print(
        f"{impacts} impacts, {events} events: |x| at most 1 + {far - 1.0:.1e}; {time.process_time() - began:.0f} s"
    )


if __name__ == "__main__":
    main()
