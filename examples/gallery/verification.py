"""Three verification runs at one forcing: symmetric impacts, asymmetric impacts, and what follows them.

Paper: figure with G = 3.3, r = 0.76, mu = 0.5, g = 0.211 and Omega = 0.977, 0.983, 0.986: two symmetric
impacts, two asymmetric impacts, four impacts in two periods. Damping (not printed): lambda = 0.9, with
which the first two come true.

Confirms the first two. Contradicts the third: at Omega = 0.986 the machine does not double its period; it
sticks or turns in the longer flight and repeats after one period. A period of two comes out only if the
sign of the friction is frozen from impact to impact, as the maps have it (last row: the same machine
integrated with that rule).
"""

import numpy as np
import paper
from scipy.integrate import solve_ivp

from orbits.attractors import find_attractor

FREQUENCIES = (0.977, 0.983, 0.986)


def frozen(machine, state, flights: int):
    """Integrate the coupled machine with the friction's sign kept from one impact to the next.

    Returns the impacts (flights, 6): tau, wall, v, v', w' after, least s w' of the flight; and the last
    two periods' motion.
    """
    eps, lam, omega, force = machine.mass_ratio, machine.damping, machine.frequency, machine.forcing
    pull = machine.friction * machine.gravity
    tau, (w, rate, v, v_rate) = 0.0, state
    rows, path = [], []
    for _ in range(flights):
        side = -1.0 if w > 0 else 1.0

        def motion(t, y, side=side):
            q1, p1, _, p2 = y
            base = eps * force * (np.sin(omega * t) + eps * lam * omega * np.cos(omega * t))
            return [p1, base - eps * lam * p1 - q1 - eps * pull * side, p2, pull * side]

        def hit(t, y):
            return 1.0 - (y[0] - y[2]) ** 2

        hit.terminal, hit.direction = True, -1.0
        q1, p1 = (v + eps * w) / (1 + eps), (v_rate + eps * rate) / (1 + eps)
        first = [q1, p1, q1 - w, p1 - rate]
        run = solve_ivp(
            motion, (tau, tau + 40), first, events=hit, method="DOP853", rtol=1e-9, atol=1e-11, max_step=0.4
        )
        q1, p1, q2, p2 = run.y[:, -1]
        if len(rows) >= flights - 4:
            fine = np.linspace(run.t[0], run.t[-1], 200)
            y = solve_ivp(motion, (fine[0], fine[-1]), first, t_eval=fine, rtol=1e-9, atol=1e-11).y
            path.append(np.column_stack([fine, y[0] - y[2], y[1] - y[3]]))
        tau, v, v_rate = float(run.t[-1]), q1 + eps * q2, p1 + eps * p2
        w = float(np.sign(q1 - q2))
        slowest = float(np.min(side * (run.y[1] - run.y[3])))
        rate = -machine.restitution * (p1 - p2)
        rows.append([tau, w, v, v_rate, rate, slowest])
    return np.array(rows), np.concatenate(path)


def main():
    figure, panels = paper.panels(9.2, 9.6, 4, 2)
    numbers = {}
    start = {"q1": 1.0, "q2": 1.0}
    machine = None
    for row, omega in zip(panels, FREQUENCIES):
        machine = paper.coupled(3.3, frequency=omega)
        found = find_attractor(machine, start, transient=600)
        paper.portrait(row, machine, found.state, 2)
        row[0].set_title(rf"$\Omega={omega}$: {found.word.text if found.word else found.kind}")
        numbers[f"Omega = {omega}: word, periods, impacts"] = (found.text, found.periods, found.impacts)
        numbers[f"Omega = {omega}: symmetric"] = found.symmetric
        numbers[f"Omega = {omega}: largest multiplier"] = float(np.max(np.abs(found.multipliers)))
        numbers[f"Omega = {omega}: max |q1|/b"] = paper.peak(found)
    impacts, path = frozen(machine, (1.0, -0.9, -0.6, 0.4), 2000)
    pattern = impacts[-64:]
    for repeat in (1, 2, 4, 8):
        if np.max(np.abs(pattern[2 * repeat :, 2:5] - pattern[: -2 * repeat, 2:5])) < 1e-3:
            break
    else:
        repeat = 0
    panels[3, 0].plot((path[:, 0] - path[0, 0]) * FREQUENCIES[2] / (2 * np.pi), path[:, 1], color=paper.RED)
    panels[3, 0].set(
        xlabel="forcing periods",
        ylabel="$w$",
        title=r"$\Omega=0.986$, "
        + ("frozen" if paper.narrow() else "friction's sign frozen in flight: no machine"),
    )
    panels[3, 1].plot(path[:, 1], path[:, 2], color=paper.RED)
    panels[3, 1].set(xlabel="$w$", ylabel="$w'$", xlim=(1.1, -1.1), xticks=(1, 0, -1))
    numbers["Omega = 0.986, friction's sign frozen: periods until it repeats (0: not found)"] = repeat
    numbers["Omega = 0.986, friction's sign frozen: least s w' in flight"] = float(np.min(pattern[:, 5]))
    beside_title = {"loc": "lower right", "bbox_to_anchor": (1.02, 1.0), "ncols": 2}
    paper.legend(panels[0, 0], **beside_title, fontsize=7.5)
    return figure, numbers


if __name__ == "__main__":
    paper.run("verification", main)
