"""Proves the verdicts of ERRATA.md and writes their certificates beside this file.

python examples/certificates/make.py        # prove and write
contvines prove examples/certificates/errata.json --check
"""

import json
from pathlib import Path

import numpy as np

from orbits import Absorber, Coupled

STRONG = {"restitution": 0.76, "friction": 0.5, "gravity": 0.211, "mass_ratio": 0.006}
HERE = Path(__file__).parent

# starts for Newton's method, (phase, B or w, ...) per event
BARE = [[5.7669, 1.8432], [7.7105, -1.0096]]
BARE_TWICE = [
    [6.178324, 1.821254, -0.436023, 0.807516],
    [8.104631, -1.008085, 0.919544, 0.124139],
    [12.415423, 1.798330, -0.473469, 0.786838],
    [14.393303, -0.994733, 0.920381, 0.119428],
]


def doubling(machine, word, guess, amplitude):
    """The period doubling of a word near this amplitude."""
    orbit = machine.orbit(word, 1, guess=guess, amplitude=amplitude)
    problem = orbit.problem("amplitude", symmetric=False)
    return problem.prove("period-doubling", *orbit.seed(problem))


def main():
    """All verdicts by name."""
    reduced = Absorber(**STRONG)
    coupled = Coupled(**STRONG, damping=0.9, forcing=3.3)
    proofs = {}

    # 5: the multiplier -1 of the printed maps belongs to no motion of the machine; a real doubling does exist
    proofs["doubling of the printed maps"] = doubling(reduced, "LR", BARE, 0.9315964326419)
    real = reduced.orbit("LttR", 1, amplitude=1.06219817632)
    proofs["doubling of the machine"] = doubling(reduced, "LttR", real.nodes, 1.06219817632)

    # 4: pure sliding begins at h^2 (1 + 4/pi^2); between the printed bound and this the machine sticks
    h = np.pi / 2 * 1.006 * 0.5 * 0.211
    edge = h * np.sqrt(1 + 4 / np.pi**2)
    border = reduced.orbit("tt", 1, amplitude=float(edge))
    problem = border.problem("amplitude", symmetric=True)
    turn = 1  # the turn is the second margin of the first event
    proofs["pure sliding begins"] = problem.prove("stick", *border.seed(problem), margin=turn)
    proofs["sliding above the printed bound"] = reduced.orbit("tt", 1, amplitude=0.18).prove()
    proofs["stick-slip above the printed bound"] = reduced.orbit("s-s+", 1, amplitude=0.18).prove()

    # 5: the motion of two periods at Omega = 0.986 exists in the maps only; the machine's motion has one
    twice = coupled.orbit("LRLR", 2, guess=BARE_TWICE, frequency=0.986)
    proofs["two periods at 0.986"] = twice.prove()
    proofs["one period at 0.986"] = coupled.orbit("LttR", 1, frequency=0.986).prove()
    return proofs


if __name__ == "__main__":
    found = main()
    for name, proof in found.items():
        print(f"{name}: {proof}")
    made = {name: proof.certificate() for name, proof in found.items()}
    (HERE / "errata.json").write_text(json.dumps(made, indent=1) + "\n", encoding="utf-8")
