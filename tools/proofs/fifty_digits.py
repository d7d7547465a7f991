"""Independent computation of orbits to 50 digits with mpmath: flights as matrix exponentials, shooting over the whole period.

Between events every motion is linear, y' = M y with y = (w, w', sin Psi, cos Psi, 1) or (q1, q1', q2, q2', sin Psi, cos Psi, 1), so a flight is
expm(M t) y. No closed form of the package or of its proofs is used. Run as a program, it writes `fifty_digits.json`.
"""

import json
from pathlib import Path

import numpy as np
from mpmath import cos, expm, matrix, mp, mpf, pi, sin

from orbits import Absorber, Cavity, Coupled

FILE = Path(__file__).with_name("fifty_digits.json")
SET = {"restitution": "0.76", "friction": "0.5", "gravity": "0.211", "mass_ratio": "0.006"}
WALL = {"L": 1, "R": -1}
UNLIKE = {
    "restitution_left": "0.7", "restitution_right": "0.8", "friction_left": "0.4", "friction_right": "0.3",
    "distance_left": "1.1", "distance_right": "0.9", "gravity": "0.2", "mass_ratio": "0.006", "slope": "0.1", "frequency": "1",
}  # fmt: skip
ON_END = {
    "restitution_left": "0.8", "restitution_right": "0.8", "friction_left": "0", "friction_right": "0",
    "distance_left": "1000", "distance_right": "1", "gravity": "1", "mass_ratio": "0", "slope": "1.5707963267948966", "frequency": "1",
}  # fmt: skip


def cases():
    """Return all cases (machine, word, periods, parameters as decimals): 35 absorbers and 9 cavities, two of which are a bouncing ball."""
    reduced = SET | {"frequency": "1"}
    found = [("absorber", "LR", 1, reduced | {"amplitude": f"0.{c}"}) for c in range(30, 100, 4)]
    found += [
        ("absorber", "LRtt", 1, reduced | {"amplitude": a}) for a in ("0.95", "1.0", "1.05", "1.1", "1.2")
    ]
    found += [("absorber", "LRLt", 1, reduced | {"amplitude": a}) for a in ("1.1", "1.2", "1.3")]
    coupled = SET | {"forcing": "2.47", "damping": "1", "excitation": "1"}
    found += [
        ("coupled", "LR", 1, coupled | {"frequency": f}) for f in ("1.004", "1.006", "1.01", "1.015", "1.02")
    ]
    found += [
        ("coupled", "LR", 1, coupled | {"frequency": "1.01", "friction": m})
        for m in ("0.1", "0.2", "0.3", "0.4")
    ]
    found += [("cavity", "LR", 1, UNLIKE | {"amplitude": a}) for a in ("0.68", "0.7", "0.75")]
    found += [("cavity", "LttR", 1, UNLIKE | {"amplitude": a}) for a in ("0.8", "0.9")]
    found += [("cavity", "LRtt", 1, UNLIKE | {"amplitude": a}) for a in ("1.0", "1.1")]
    found += [("cavity", "R", 1, ON_END | {"amplitude": a}) for a in ("0.6", "0.8")]
    return found


def sides(p):
    """Return side (1 left, -1 right) -> position of the wall, its restitution, and the friction of sliding in the mode of this sign."""
    names = {1: "left", -1: "right"}
    return {
        s: (
            s * p.get(f"distance_{name}", 1),
            p.get(f"restitution_{name}", p.get("restitution")),
            p.get(f"friction_{name}", p.get("friction")),
        )
        for s, name in names.items()
    }


def generator(machine, p, mode):
    """Return the matrix M of one mode."""
    omega, eps, r = p["frequency"], p["mass_ratio"], sides(p)[mode][2] * p["gravity"] if mode else 0
    if machine != "coupled":
        M = matrix(5, 5)
        M[0, 1] = 1
        # on a slope the normal force is proportional to cos, and gravity pulls with sin towards the right wall
        tilt = p.get("slope", mpf(0))
        force = -mode * r * cos(tilt) - p["gravity"] * sin(tilt)
        M[1, 2], M[1, 4] = -p["amplitude"] * omega**2, (1 + eps) * force
        at = 2
    else:
        M = matrix(7, 7)
        drag, force = eps * p["damping"], eps * p["forcing"]
        M[0, 1] = M[2, 3] = 1
        M[1, 0], M[1, 1], M[1, 4], M[1, 5] = -1, -drag, force, p["excitation"] * force * drag * omega
        M[1, 6], M[3, 6] = -eps * mode * r, mode * r
        at = 4
    M[at, at + 1], M[at + 1, at] = omega, -omega
    return M


def relative(machine, y):
    """Return w, w', v, v' of a state."""
    if machine != "coupled":
        return y[0], y[1], None, None
    return y[0] - y[2], y[1] - y[3], None, None


def shot(machine, word, periods, p, x):
    """Return the residuals of the shooting equations, and the nodes; x contains the phases of the events, B+ and, for the coupled machine, v, v'."""
    n, eps, omega = len(word.events), p["mass_ratio"], p["frequency"]
    walls = {letter: sides(p)[s][:2] for letter, s in WALL.items()}
    phases = [*x[:n], x[0] + 2 * pi * periods]
    s, c = sin(phases[0]), cos(phases[0])
    wall = walls[word.events[0]][0]
    if machine != "coupled":
        y = matrix([wall, p["amplitude"] * omega * c - x[n], s, c, 1])
    else:
        q2r = x[n] / (1 + eps)
        y = matrix(
            [
                (x[n + 1] + eps * wall) / (1 + eps),
                x[n + 2] - eps * q2r,
                (x[n + 1] - wall) / (1 + eps),
                q2r,
                s,
                c,
                1,
            ]
        )
    start, rows, nodes = y.copy(), [], []
    for i in range(n):
        nodes.append(node(machine, word.events[i], y, p, phases[i]))
        M = generator(machine, p, word.modes[i])
        y = expm(M * ((phases[i + 1] - phases[i]) / omega), method="taylor") * y
        letter = word.events[(i + 1) % n]
        w, rate, *_ = relative(machine, y)
        rows.append(w - walls[letter][0] if letter in WALL else rate)
        if letter in WALL:  # w' is reversed, v' does not change
            r = walls[letter][1]
            if machine != "coupled":
                y[1] = -r * rate
            else:
                y[1], y[3] = y[1] - eps * (1 + r) * rate / (1 + eps), y[3] + (1 + r) * rate / (1 + eps)
    rows += [y[1] - start[1]] if machine != "coupled" else [y[j] - start[j] for j in (0, 1, 3)]
    return rows, nodes


def node(machine, letter, y, p, phase):
    """Return the node (Psi, B+ or w[, v, v']) of a state after an event."""
    if machine != "coupled":
        B = p["amplitude"] * p["frequency"] * y[3] - y[1]
        return [phase, B if letter in WALL else y[0]]
    eps = p["mass_ratio"]
    return [phase, (1 + eps) * y[3] if letter in WALL else y[0] - y[2], y[0] + eps * y[2], y[1] + eps * y[3]]


def floating(machine, word, periods, given):
    """Return the orbit in double precision, as start values."""
    values = {name: float(value) for name, value in given.items()}
    if machine == "absorber":
        own = {
            name: values[name] for name in ("restitution", "friction", "gravity", "mass_ratio", "frequency")
        }
        made = Absorber(**own)
        if word == "LR":
            return made.symmetric_orbit(values["amplitude"])
        return made.orbit(word, periods, amplitude=values["amplitude"])
    if machine == "cavity":
        amplitude = values.pop("amplitude")
        return Cavity(**values).orbit(word, periods, amplitude=amplitude)
    frequency = values.pop("frequency")
    return Coupled(**values).symmetric_orbit(frequency=frequency)


def solve(machine, text, periods, given, digits=60):
    """Return the orbit in double precision, and its nodes to 50 digits."""
    orbit = floating(machine, text, periods, given)
    with mp.workdps(digits):
        p = {name: mpf(value) for name, value in given.items()}
        x = [mpf(float(v)) for v in orbit.nodes[:, 0]] + [mpf(float(v)) for v in orbit.nodes[0, 1:]]
        if machine == "coupled" and orbit.nodes.shape[1] == 4:
            x = x[: len(orbit.word) + 3]
        for _ in range(6):
            F = matrix(shot(machine, orbit.word, periods, p, x)[0])
            if max(abs(v) for v in F) < mpf(10) ** (5 - digits):
                break
            step = mpf(10) ** (-digits // 2)
            J = matrix(len(x), len(x))
            for j in range(len(x)):
                moved = [*x]
                moved[j] += step
                column = matrix(shot(machine, orbit.word, periods, p, moved)[0])
                for i in range(len(x)):
                    J[i, j] = (column[i] - F[i]) / step
            x = [a - b for a, b in zip(x, mp.lu_solve(J, F))]
        nodes = shot(machine, orbit.word, periods, p, x)[1]
        return orbit, [[mp.nstr(v, 50) for v in row] for row in nodes]


def main():
    """Write all cases."""
    found = []
    for machine, text, periods, given in cases():
        orbit, nodes = solve(machine, text, periods, given)
        assert np.allclose(np.array(nodes, float), orbit.nodes, atol=1e-9)
        found.append(
            {"machine": machine, "word": text, "periods": periods, "parameters": given, "nodes": nodes}
        )
        print(machine, text, given.get("amplitude") or given["frequency"], flush=True)
    FILE.write_text(json.dumps(found, indent=1) + "\n")


if __name__ == "__main__":
    main()
