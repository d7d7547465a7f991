"""Check every example machine file with random parameters and random starts.

`python -m tools.pages.draws [COUNT] [NAME ...]` counts two kinds of errors for each machine file: a real and stable orbit
that simulation leaves, and a simulated periodic attractor of up to four periods whose word has no solution. Whether a motion
is periodic is decided by its states once per forcing period (for a self-excited machine: after each event), without words.
"""

import sys
import time

import numpy as np

import contvines as cv
from orbits.contacts import HOLD, RELEASE
from orbits.flows.page.simulator import collect, outside
from orbits.flows.page.stepper import TWO_PI, SimulationError, Stepper
from tools.pages.pages import page

# intervals of uniformly distributed parameters; all others have the values of the machine file
RANGES = {
    "impact_oscillator": {"frequency": (0.6, 4.0), "damping": (0.0, 0.2), "gap": (-0.3, 0.8), "restitution": (0.4, 0.95)},
    "bouncing_ball": {"amplitude": (0.02, 0.4), "restitution": (0.3, 0.9)},
    "den_hartog": {"frequency": (0.12, 2.5), "friction": (0.05, 0.95)},
    "belt_slider": {"belt": (0.1, 2.5), "damping": (0.0, 0.15), "least": (0.2, 0.9), "weakening": (1.0, 8.0)},
    "elastic_stop": {"frequency": (0.4, 2.0), "damping": (0.02, 0.15), "stiffness": (1.0, 40.0), "gap": (0.2, 1.5)},
    "rubber_wall": {"frequency": (0.4, 2.0), "stiffness": (5.0, 60.0), "loss": (0.2, 4.0), "gap": (0.2, 0.9)},
    "impact_duffing": {"forcing": (0.1, 0.8), "frequency": (0.4, 2.0), "gap": (0.1, 0.8), "restitution": (0.4, 0.95)},
    "two_absorbers": {"forcing": (0.01, 0.05), "frequency": (0.97, 1.05), "restitution": (0.4, 0.9), "far": (0.3, 0.6)},
    "absorber": {"amplitude": (0.1, 1.5), "restitution": (0.4, 0.95), "friction": (0.0, 0.8)},
    "coupled": {"forcing": (0.5, 4.0), "frequency": (0.95, 1.06), "restitution": (0.4, 0.9), "friction": (0.0, 0.8)},
}  # fmt: skip
SETTLING = 500  # forcing periods (events of a self-excited machine) before the period is determined
RECURS = 1e-8  # largest difference of recurring states, relative to 1 + states
MOST = 4  # longest period, in forcing periods
KICKS = (1e-6, 1e-8)  # perturbations; with a narrow basin only the smaller one stays in it
LEAVES = 1e-3  # distance from an orbit, relative to 1 + states, above which a simulation has left it
ROUNDS = 40  # periods of the orbit that are simulated
CALM = 0.95  # largest modulus of multipliers for which a perturbed motion returns within these periods


def drawn(name: str, generator: np.random.Generator) -> tuple[dict[str, float], np.ndarray, float]:
    """Draw parameters and a start (state and phase) outside the walls."""
    machine = page(name)
    parameters = {key: float(generator.uniform(*limits)) for key, limits in RANGES[name].items()}
    state = generator.uniform(-1.0, 1.0, machine.size)
    phase = float(generator.uniform(0.0, TWO_PI)) if machine.forced else 0.0
    stepper = Stepper(machine, machine.vector(parameters))
    return parameters, outside(stepper, state, phase), phase


def recurrence(machine, parameters, state, phase) -> int:
    """Return the period (in forcing periods; in events of a self-excited machine) of the motion on which a simulation settles; 0 for none, or if a wall holds the body."""
    stepper = Stepper(machine, machine.vector(parameters))
    stepper.start(state, phase)
    rows, events = [], []
    if machine.forced:
        for turn in range(SETTLING + 2 * MOST + 1):
            until = TWO_PI * (turn + 1)
            while (event := stepper.advance(until)) is not None:
                if turn >= SETTLING:
                    events.append(event)
            if turn >= SETTLING:
                rows.append(stepper.state.copy())
        longest = MOST
    else:
        run = collect(stepper, np.inf, SETTLING)
        rows, events, longest = list(run.states[-60:]), run.events[-60:], 20
    if any(kind in (HOLD, RELEASE) for _, kind, _ in events) or any(
        hasattr(c, "gap") and m for c, m in zip(machine.contacts, stepper.modes)
    ):
        return 0
    table = np.array(rows)
    scale = RECURS * (1.0 + np.abs(table).max())
    kept = range(1, min(longest, (len(table) - 1) // 2) + 1)
    gaps = {k: np.abs(table[k:] - table[:-k]).max() for k in kept}
    period = next((k for k, gap in gaps.items() if gap < scale), 0)
    # the motion may still converge, with alternating sides, to one with a shorter period
    return 0 if any(gaps[k] < 1e3 * scale for k in range(1, period)) else period


def stays(orbit) -> bool:
    """Whether the simulation follows a stable orbit, and returns to it after a small perturbation."""
    if not orbit.replay() < 1e-6:
        return False
    if not len(orbit.multipliers) or np.abs(orbit.multipliers[0]) > CALM or orbit.margin < 1e-3:
        return True
    return any(comes_back(orbit, kick) for kick in KICKS)


def comes_back(orbit, kick) -> bool:
    """Whether a perturbed simulation is on the orbit again after `ROUNDS` periods."""
    machine, nodes = orbit.model, orbit.nodes
    stepper = Stepper(machine, orbit.params)
    clock = float(nodes[0, 0]) if machine.forced else 0.0
    stepper.start(outside(stepper, nodes[0, 1:] * (1.0 + kick), clock), clock, orbit.word.modes[0])
    loose = orbit.system(symmetric=False).loose
    known = [j for j in range(machine.size) if j not in loose]
    try:
        if machine.forced:  # compared in the middle of the longest flight
            spans = orbit.durations
            place = int(np.argmax(spans))
            begin = float(nodes[place, 0])
            middle = begin + 0.5 * float(spans[place])
            run = collect(stepper, middle - clock + TWO_PI * orbit.periods * ROUNDS, 10**5)
            mode = orbit.word.mode(place)
            watch = machine.compiled.watch(machine.equations.pattern_key(mode))
            numbers = machine.compiled.numbers(orbit.params, mode)
            claimed = watch.path(nodes[place, 1:], np.array([begin, middle]), numbers)[-1]
            gap = np.abs(stepper.state - claimed)[known].max()
        else:
            run = collect(stepper, np.inf, len(orbit.word) * ROUNDS)
            gap = np.abs(run.states[-1] - nodes[0, 1:])[known].max()
    except SimulationError:
        return False
    return bool(gap < LEAVES * (1.0 + np.abs(nodes[:, 1:]).max()))


def examined(name: str, parameters, state, phase) -> tuple[str, list[str]]:
    """Simulate from the start; return the kind of the motion and a list of errors."""
    machine = page(name)
    start = {**dict(zip(machine.states, map(float, state))), **({"phase": phase} if machine.forced else {})}
    try:
        period = recurrence(machine, parameters, state, phase)
        found = machine.attractor(start, **parameters)
    except SimulationError as error:
        return "refused", [] if "slide along it" in str(error) else [f"simulation: {error}"]
    wrong = []
    if period and found.orbit is None:
        wrong.append(f"a motion of period {period} is called {found.kind}")
    if period and found.orbit is not None:
        told = found.orbit.periods if machine.forced else max(1, len(found.orbit.word))
        if told != period:
            wrong.append(f"a motion of period {period} is called one of {told}")
    if found.orbit is None:
        return found.kind, wrong
    orbit = found.orbit
    if not orbit.real:
        wrong.append(f"{orbit.word.text!r} is simulated and has the margin {orbit.margin:.2e}")
    if orbit.real and orbit.stable and not stays(orbit):
        wrong.append(f"{orbit.word.text!r} is called real and stable, and simulation leaves it")
    return "periodic", wrong


def continued(name: str, parameters, state, phase) -> tuple[int, list[str]]:
    """Follow the branch through the attractor; return the number of stable orbits that were checked, and those that simulation leaves."""
    machine = page(name)
    start = {**dict(zip(machine.states, map(float, state))), **({"phase": phase} if machine.forced else {})}
    orbit = machine.attractor(start, **parameters).orbit
    if orbit is None:
        return 0, []
    over = next(iter(RANGES[name]))
    p = orbit.parameters[over]
    graph = cv.diagram(orbit, over=over, within=(0.8 * p, 1.2 * p), depth=1)
    asked, wrong = 0, []
    for branch in graph.branches.values():
        inside = [i for i in range(1, len(branch) - 1) if branch.stable[i - 1 : i + 2].all()]
        for i in inside[:: max(1, len(inside) // 4)]:
            asked += 1
            there = branch.orbit(i)
            if there.real and there.stable and not stays(there):
                wrong.append(f"{there.word.text!r} at {over} = {branch.values[i]:.6g}")
    return asked, wrong


def main() -> None:
    """Count the errors of every machine file."""
    arguments = sys.argv[1:]
    count = int(arguments.pop(0)) if arguments and arguments[0].isdigit() else 100
    for name in arguments or RANGES:
        generator = np.random.default_rng(14)
        began, kinds, bad, asked = time.process_time(), {}, 0, 0
        for k in range(count):
            given = drawn(name, generator)
            kind, wrong = examined(name, *given)
            kinds[kind] = kinds.get(kind, 0) + 1
            if kind == "periodic" and k % 5 == 0:
                more, left = continued(name, *given)
                asked += more
                wrong += left
            for sentence in wrong:
                bad += 1
                parameters, state, phase = given
                print(f"  {name} {k}: {sentence}; {parameters}, {state.tolist()}, {phase}", flush=True)
        told = ", ".join(f"{n} {kind}" for kind, n in sorted(kinds.items()))
        seconds = time.process_time() - began
        print(
            f"{name}: {count} draws ({told}; {asked} orbits of branches), {bad} wrong; {seconds:.0f} s",
            flush=True,
        )


if __name__ == "__main__":
    main()
