"""Compare a declared machine with the same computation by solve_ivp: time per point of a continuation, and per event of a simulation.

`python -m tools.benchmarks.declared` prints ratios; times are medians of interleaved rounds in one process.
"""

import time

import numpy as np
from scipy.integrate import solve_ivp

from orbits import Machine, Wall
from orbits.symbols import sin

PARAMETERS = {"forcing": 5.0, "frequency": 1.0, "damping": 0.05, "restitution": 0.7}


def page() -> Machine:
    """A forced mass between two walls, with two states and two impacts per period."""
    return Machine(
        name="rattling",
        states=("x", "v"),
        parameters=PARAMETERS,
        phase_rate="frequency",
        motion=lambda s, phase, p, contact: (s.v, p.forcing * sin(phase) - 2 * p.damping * s.v - s.x**3),
        contacts=[
            Wall("L", lambda s, phase, p: 1 - s.x, {"v": -1.0}, "restitution"),
            Wall("R", lambda s, phase, p: 1 + s.x, {"v": 1.0}, "restitution"),
        ],
        mirror={"L": "R"},
    )


def rates(t, y, forcing, frequency, damping):
    """Rates of the states and of their derivatives by initial states and frequency."""
    x, v = y[:2]
    out = np.empty(8)
    out[0], out[1] = v, forcing * np.sin(frequency * t) - 2 * damping * v - x**3
    jacobian = np.array([[0.0, 1.0], [-3 * x**2, -2 * damping]])
    out[2:6] = (jacobian @ y[2:6].reshape(2, 2)).ravel()
    out[6:] = jacobian @ y[6:] + np.array([0.0, forcing * t * np.cos(frequency * t)])
    return out


def shooting(nodes: np.ndarray, frequency: float, length: int) -> np.ndarray:
    """One sweep of the same multiple shooting: integrate every flight with its variational equations by DOP853 at 1e-10."""
    begin = nodes[:, 0] / frequency
    end = np.append(begin[1:], begin[0] + 2 * np.pi * length / 2 / frequency)
    found = []
    for i in range(length):
        y0 = np.concatenate([nodes[i, 1:], np.eye(2).ravel(), np.zeros(2)])
        run = solve_ivp(
            rates, (begin[i], end[i]), y0, "DOP853", args=(5.0, frequency, 0.05), rtol=1e-10, atol=1e-10
        )
        found.append(run.y[:, -1])
    return np.array(found)


def times(repeat: int = 7) -> dict[str, float]:
    """Return seconds of compiling and solving a machine file, of a point (three sweeps, multipliers, margins), of an event, and the same by solve_ivp."""
    machine = page()
    machine.simulate({"x": 0.0}, events=1)  # start-up of the integrator
    began = time.perf_counter()
    machine = page()
    machine.simulate({"x": 0.0}, events=1)
    key = machine.equations.pattern_key((0, 0))
    machine.compiled.flight(key, (machine.parameter_names.index("frequency"),))
    machine.compiled.watch(key), machine.compiled.guards(key)
    compiled = time.perf_counter() - began
    orbit = machine.orbit("LR")
    problem = orbit.problem("frequency", symmetric=False)
    u, p = orbit.seed(problem)
    work = problem.workspace()
    row = np.empty(2 * problem.n_multipliers + problem.n_margins)
    step, tangent, border = np.empty(7), np.empty(7), np.eye(7)[6]
    kernels = problem.kernels

    def point():
        for _ in range(3):
            kernels.linearise(problem, u, p, work)
            kernels.bordered(problem, work, border, 0.0, step, tangent)
        kernels.inspect(problem, u, p, work, row)

    point()
    nodes = u.reshape(2, 3)

    def by_solve_ivp():
        for _ in range(3):
            table = shooting(nodes, p, 2)
            for k in range(2):
                np.linalg.solve(np.eye(6), np.ones(6))
                np.linalg.eigvals(table[k, 2:6].reshape(2, 2))

    wide = {n: problem_of(orbit, n) for n in (4, 16, 64)}

    def hits(t, y, *_):
        return 1.0 - abs(y[0])

    hits.terminal, hits.direction = True, -1

    def events_by_solve_ivp(count=5):
        t, y = nodes[0, 0] / p, nodes[0, 1:].copy()
        for _ in range(count):
            run = solve_ivp(
                lambda t, y: (y[1], 5 * np.sin(p * t) - 0.1 * y[1] - y[0] ** 3),
                (t, t + 50), y, "DOP853", events=hits, rtol=1e-10, atol=1e-10,
            )  # fmt: skip
            t, y = run.t[-1], run.y[:, -1] * np.array([1.0, -0.7])
        return t

    machine.simulate(dict(zip("xv", nodes[0, 1:])), events=5)

    def simulated():
        return machine.simulate({"x": 0.0, "v": 3.0, "phase": 0.3}, events=400)

    samples = {name: [] for name in ("point", "solve_ivp point", "event", "solve_ivp event")}
    samples |= {f"point {n}": [] for n in wide}
    for _ in range(repeat):
        samples["point"].append(_timed(point, 20))
        samples["solve_ivp point"].append(_timed(by_solve_ivp, 1))
        samples["event"].append(_timed(simulated, 1) / 400)
        samples["solve_ivp event"].append(_timed(events_by_solve_ivp, 1) / 5)
        for n, run in wide.items():
            samples[f"point {n}"].append(_timed(run, 3))
    return {"page": compiled, **{name: float(np.median(values)) for name, values in samples.items()}}


def problem_of(orbit, flights: int):
    """Return a function that does one sweep, elimination and inspection of the orbit repeated to have `flights` flights."""
    long = orbit.repeat(flights // 2).problem("frequency", symmetric=False)
    u, p = orbit.repeat(flights // 2).seed(long)
    work = long.workspace()
    row = np.empty(2 * long.n_multipliers + long.n_margins)
    size = long.dimension + 1
    step, tangent, border = np.empty(size), np.empty(size), np.eye(size)[-1]

    def run():
        long.kernels.linearise(long, u, p, work)
        long.kernels.bordered(long, work, border, 0.0, step, tangent)
        long.kernels.inspect(long, u, p, work, row)

    run()
    return run


def _timed(function, times: int) -> float:
    began = time.perf_counter()
    for _ in range(times):
        function()
    return (time.perf_counter() - began) / times


def main() -> None:
    """Print the ratios."""
    found = times()
    print(f"compilation of the page: {found['page']:.2f} s")
    print(
        f"point of two flights: {1e6 * found['point']:.0f} us; solve_ivp {found['solve_ivp point'] / found['point']:.0f} times that"
    )
    print(
        f"event: {1e6 * found['event']:.0f} us; solve_ivp {found['solve_ivp event'] / found['event']:.0f} times that"
    )
    per = {n: found[f"point {n}"] / n for n in (4, 16, 64)}
    print(
        "one sweep with multipliers and margins, us per flight: "
        + ", ".join(f"{n}: {1e6 * v:.0f}" for n, v in per.items())
    )


if __name__ == "__main__":
    main()
