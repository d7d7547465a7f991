"""Proved orbits with something wrong put into them: no wrong one may be proved, no wrong certificate verified.

Run by itself for a large count: ``python -m tests.orbits.proofs.tampering 100000``.
"""

import copy
import json
import sys

import numpy as np

from orbits import Absorber, Coupled
from orbits.proofs.checker import Refused, check
from orbits.proofs.obstacles import ProofError
from orbits.proofs.prove import prove_orbit
from orbits.proofs.subjects import of_orbit

ABSORBER = Absorber(restitution=0.76, friction=0.5, gravity=0.211, mass_ratio=0.006)
COUPLED = Coupled(restitution=0.76, friction=0.5, gravity=0.211, mass_ratio=0.006, forcing=2.47, damping=1.0)
LETTERS = "LRtsu"


def orbits():
    """Orbits to tamper with: real and virtual, stable and unstable, of both machines."""
    return [
        ABSORBER.symmetric_orbit(amplitude=0.55),
        ABSORBER.symmetric_orbit(amplitude=0.9),
        ABSORBER.orbit("LRtt", 1, amplitude=1.0),
        ABSORBER.orbit("LRs", 1, amplitude=1.0),
        ABSORBER.orbit("ss", 1, amplitude=0.12),
        COUPLED.symmetric_orbit(frequency=1.01),
        COUPLED.sliding_orbit(frequency=0.99),
    ]


def arguments(orbit):
    """What `prove_orbit` takes, as a dict to tamper with."""
    return {
        "machine": orbit.model.name,
        "events": list(orbit.word.events),
        "modes": list(orbit.word.modes),
        "periods": orbit.periods,
        "nodes": orbit.nodes.copy(),
        "parameters": dict(orbit.parameters),
    }


def wrong_input(given, random):
    """One wrong thing: a node, a parameter, a letter, a mode, the number of periods. Returns what was done."""
    wrong = copy.deepcopy(given)
    kind = random.choice(["node", "parameter", "letter", "mode", "periods", "order"])
    n = len(wrong["events"])
    if kind == "node":
        place = random.integers(n), random.integers(wrong["nodes"].shape[1])
        size = 10.0 ** random.uniform(-4.5, 0.3)
        wrong["nodes"][place] += random.choice([-1, 1]) * size * (1 + abs(wrong["nodes"][place]))
    elif kind == "parameter":
        name = random.choice([n for n in wrong["parameters"] if n not in ("excitation", "damping")])
        if name == "restitution" and not {"L", "R"} & set(wrong["events"]):
            name = "gravity"  # nothing hits a wall
        if name == "mass_ratio" and given["machine"] == "absorber":
            name = "friction"
        wrong["parameters"][name] *= 1 + random.choice([-1, 1]) * 10.0 ** random.uniform(-2.5, -0.5)
        wrong["parameters"]["restitution"] = min(1.0, wrong["parameters"]["restitution"])
    elif kind == "letter":
        i = random.integers(n)
        wrong["events"][i] = random.choice([letter for letter in LETTERS if letter != wrong["events"][i]])
    elif kind == "mode":
        i = random.integers(n)
        wrong["modes"][i] = int(random.choice([m for m in (-1, 0, 1) if m != wrong["modes"][i]]))
    elif kind == "periods":
        wrong["periods"] += int(random.choice([1, 2, 3]))
    else:
        i = random.integers(1, n) if n > 1 else 0
        wrong["events"] = wrong["events"][i:] + wrong["events"][:i]
        wrong["modes"] = wrong["modes"][i:] + wrong["modes"][:i]
        if not i:
            wrong["nodes"] += 1e-3
    return kind, wrong


def false_proof(wrong, half):
    """Whether a wrong input is proved to be a real orbit, or to exist where only its numbers are wrong."""
    try:
        proof = prove_orbit(**wrong, half=half)
    except ProofError:
        return False
    return proof.existence and proof.real is not False


def certificates():
    """True certificates to tamper with, small ones."""
    return [
        json.loads(json.dumps(of_orbit(orbit).certificate())) for orbit in (orbits()[i] for i in (0, 1, 3, 5))
    ]


def wrong_certificate(given, random):
    """One wrong thing in a certificate: a claim, a node, a radius, a parameter, the word."""
    wrong = copy.deepcopy(given)
    kind = random.choice(
        ["real", "stable", "node", "radius", "parameter", "letter", "mode", "half", "periods"]
    )
    if kind in ("real", "stable"):
        wrong["claims"][kind] = not wrong["claims"][kind]
        if kind == "real" and not wrong["claims"]["real"]:
            wrong["broken"] = [random.choice(["approach", "flight", "duration", "wall"]), 0]
    elif kind in ("node", "radius"):
        node = wrong["nodes"][random.integers(len(wrong["nodes"]))]
        pair = node[random.integers(len(node))]
        if kind == "node":  # by more than the radius
            pair[0] = str(float(pair[0]) + random.choice([-1, 1]) * 10.0 ** random.uniform(-12, 0))
        else:
            pair[1] = random.choice(["0", "-" + pair[1], "1e-60"])  # a larger ball may be true
    elif kind == "parameter":
        name = random.choice(list(wrong["parameters"]))
        if name == "mass_ratio":
            name = "friction"
        wrong["parameters"][name] = str(
            float(wrong["parameters"][name]) * (1 + 10.0 ** random.uniform(-12, -1))
        )
    elif kind == "letter":
        i = random.integers(len(wrong["events"]))
        other = random.choice([letter for letter in LETTERS if letter != wrong["events"][i]])
        wrong["events"] = wrong["events"][:i] + other + wrong["events"][i + 1 :]
    elif kind == "mode":
        i = random.integers(len(wrong["modes"]))
        wrong["modes"][i] = int(random.choice([m for m in (-1, 0, 1) if m != wrong["modes"][i]]))
    elif kind == "half":
        wrong["half"] = not wrong["half"]
    else:
        wrong["periods"] += int(random.choice([1, 2, -2]))
    return kind, wrong


def verified(wrong):
    """Whether the checker accepts a certificate."""
    try:
        check(wrong)
    except Refused:
        return False
    return True


def main(count):
    """Tamper `count` times, one in a hundred times with a certificate; print how many were proved or verified."""
    random = np.random.default_rng(7)
    sound, papers = orbits(), certificates()
    found = 0
    for trial in range(count):
        if trial % 100 == 0:
            kind, wrong = wrong_certificate(papers[random.integers(len(papers))], random)
            bad = verified(wrong)
        else:
            orbit = sound[random.integers(len(sound))]
            kind, wrong = wrong_input(arguments(orbit), random)
            bad = false_proof(wrong, orbit.symmetric and bool(random.integers(2)))
        if bad:
            found += 1
            print(trial, kind, {k: v for k, v in wrong.items() if k != "nodes"}, flush=True)
        if trial % 5000 == 0:
            print(f"{trial} tried, {found} false", flush=True)
    print(f"{count} wrong inputs, {found} false proofs")
    return found


if __name__ == "__main__":
    main(int(sys.argv[1]))
