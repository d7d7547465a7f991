"""Insert errors into orbits, special points and certificates: no wrong input may be proved, and no wrong certificate verified.

Run it as a program for many trials: ``python -m tools.proofs.tampering 100000``.
"""

import copy
import functools
import json
import sys

import numpy as np

import contvines as cv
from orbits import Absorber, Coupled
from orbits.proofs.checker import Refused, check
from orbits.proofs.obstacles import ProofError
from orbits.proofs.prove import prove_orbit
from orbits.proofs.subjects import of_orbit

ABSORBER = Absorber(restitution=0.76, friction=0.5, gravity=0.211, mass_ratio=0.006)
COUPLED = Coupled(restitution=0.76, friction=0.5, gravity=0.211, mass_ratio=0.006, forcing=2.47, damping=1.0)
LETTERS = "LRtsu"
FELT = ("friction", "gravity", "restitution")  # numbers that influence all orbits used here


@functools.cache
def orbits():
    """Return the orbits that are changed: real and virtual, stable and unstable, of both machines."""
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
    """Return the arguments of `prove_orbit` for an orbit, as a dict."""
    return {
        "machine": orbit.model.name,
        "events": list(orbit.word.events),
        "modes": list(orbit.word.modes),
        "periods": orbit.periods,
        "nodes": orbit.nodes.copy(),
        "parameters": dict(orbit.parameters),
    }


def wrong_input(given, random):
    """Insert one error: a node, a parameter, a letter, a mode, or the number of periods; return its kind and the input."""
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
            name = "gravity"  # without impacts the restitution has no influence
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
    """Whether a wrong input is proved to exist and not proved to be virtual."""
    try:
        proof = prove_orbit(**wrong, half=half)
    except ProofError:
        return False
    return proof.existence and proof.real is not False


# ------------------------------------------------------------------ special points
@functools.cache
def graph():
    """Compute a graph with a fold, a symmetry breaking and borders."""
    seed = ABSORBER.symmetric_orbit(amplitude=0.6)
    return cv.diagram(seed, over="amplitude", within=(0.24, 0.9), depth=1)


@functools.cache
def points():
    """Return (problem, kind, u, value, margin) of special points, all of which can be proved without an error."""
    named = [p for p in graph().special.values() if p.kind != "end"]
    found = [(p.problem, p.kind, p.u, float(p.value), p.margin_index) for p in named]
    doubling = ABSORBER.orbit("LttR", 1, amplitude=1.06219817632)
    problem = doubling.problem("amplitude", symmetric=False)
    found.append((problem, "period-doubling", *doubling.seed(problem), None))
    neimark = COUPLED.symmetric_orbit(frequency=1.02540971532)
    problem = neimark.problem("frequency", symmetric=True)
    found.append((problem, "neimark-sacker", *neimark.seed(problem), None))
    return found


def wrong_point(given, random):
    """Insert one error into a special point: its kind, margin, a node, its value, or a number of its machine; return its kind and the point."""
    problem, kind, u, value, margin = given
    what = random.choice(["kind", "margin", "node", "value", "machine"])
    if what == "margin" and margin is None:
        what = "kind"
    phases = problem.expand(np.array(u))[:, 0]
    if what == "node" and np.min(np.diff(phases), initial=1.0) < 1e-3:
        what = "value"  # a flight of duration zero is left out by the proof, so its node has no influence
    if what == "kind":
        kinds = ["fold", "symmetry-breaking", "period-doubling", "neimark-sacker"]
        kind = random.choice([other for other in kinds if other != kind])
        margin = None
    elif what == "margin":
        others = [
            m for m in range(problem.n_margins) if 1 < abs(m // 4 - margin // 4) < problem.n_margins // 4 - 1
        ]
        margin = int(random.choice(others or [(margin + 1) % 4 + 4 * (margin // 4)]))
        kind = problem.margin_kind(margin)
    elif what == "node":
        u = np.array(u)
        place = random.integers(u.size)
        u[place] += random.choice([-1, 1]) * 10.0 ** random.uniform(-4.5, -0.3) * (1 + abs(u[place]))
    elif what == "value":
        value *= 1 + random.choice([-1, 1]) * 10.0 ** random.uniform(-4.5, -0.5)
    else:
        name = random.choice(["friction", "gravity", "restitution"])
        size = 1 + random.choice([-1, 1]) * 10.0 ** random.uniform(-2.5, -0.7)
        problem = problem.against(problem.parameter, {name: problem.parameters[name] * size})
    return what, (problem, kind, u, value, margin)


def false_point(wrong):
    """Whether a wrong special point is proved."""
    problem, kind, u, value, margin = wrong
    try:
        proof = problem.prove(kind, u, value, margin=margin)
    except ProofError:
        return False
    return proof.existence and proof.kind == kind


# ------------------------------------------------------------------ certificates
@functools.cache
def certificates():
    """Return right certificates of small size: orbits, special points of every kind, a stretch of a branch."""
    proofs = [of_orbit(orbit) for orbit in (orbits()[i] for i in (0, 1, 3, 5))]
    proofs += [problem.prove(kind, u, p, margin=margin) for problem, kind, u, p, margin in points()]
    (stretch,) = (p for p in graph()["B1"].prove(within=(0.592, 0.6)).pieces if p.stable)
    return [json.loads(json.dumps(proof.certificate())) for proof in [*proofs, stretch]]


def wrong_certificate(given, random):
    """Insert one error into a certificate: a claim, a box, a parameter, the word, or the kind of point; return its kind and the certificate."""
    wrong = copy.deepcopy(given)
    tiles = wrong["boxes"][1::2]
    special = tiles[0]["kind"] if tiles else None
    kinds = ["real", "node", "radius", "parameter", "letter", "mode", "half", "periods", "frictionless"]
    kinds += ["existence", "unknown", "absent", "other format", "exponent", "value", "value's radius"]
    kinds += ["stable"] if wrong["claims"]["stable"] is not None else ["stable at a point"] if special else []
    kinds += ["slope", "width", "missing", "end"] if tiles else ["slope of an orbit", "width of an orbit"]
    kinds += ["kind"] if special else ["kind of a tile"]
    kinds += ["condition"] if special == "border" else ["condition without a border"]
    kind = str(random.choice(kinds))
    box = wrong["boxes"][random.integers(len(wrong["boxes"]))]
    node = box["nodes"][random.integers(len(box["nodes"]))]
    triple = node[random.integers(len(node))]
    if kind in ("real", "stable", "existence"):
        wrong["claims"][kind] = not wrong["claims"][kind]
    elif kind == "stable at a point":
        wrong["claims"]["stable"] = bool(random.integers(2))
    elif kind == "unknown":
        told = random.choice([wrong, wrong["claims"], box, wrong["parameters"]])
        told[str(random.choice(["value", "covered", "ends", "point", "remark"]))] = ["1", "0", "0"]
    elif kind == "absent":
        told = random.choice([wrong, wrong["claims"], box, wrong["parameters"]])
        del told[str(random.choice(list(told)))]
    elif kind == "other format":
        wrong["format"] = str(random.choice(["contvines certificate 2", "certificate", ""]))
    elif (
        kind == "value"
    ):  # shift an orbit by more than the width of its tile; a tile by more than the distance of the orbits
        at = box["parameter"]
        size = 10.0 ** random.uniform(0.5, 6) * (2 * float(tiles[0]["half_width"]) + 1e-4 if tiles else 1e-9)
        at[0] = repr(float(at[0]) + random.choice([-1, 1]) * size)
    elif kind == "value's radius":
        at = box["parameter"]
        at[2] = str(random.choice(["1e-30", "1e-9", "-1e-9"])) if at[2] == "0" else "0"
    elif kind == "slope of an orbit":
        triple[1] = str(random.choice(["1", "-1e-9", "1e-30"]))
    elif kind == "width of an orbit":
        box["half_width"] = str(random.choice(["1e-30", "1e-9", "-1e-9"]))
    elif kind == "kind of a tile":
        names = ["fold", "symmetry-breaking", "period-doubling", "neimark-sacker", "border", "user"]
        (tiles[0] if tiles else box)["kind"] = str(random.choice(names))
    elif kind == "condition without a border":
        box["conditions"] = [["flight", int(random.integers(len(wrong["events"]))), 1]]
    elif kind == "node":  # shift it by more than the radius
        size = 10.0 ** random.uniform(0.5, 5) * (float(triple[2]) + 1e-13)
        triple[0] = repr(float(triple[0]) + random.choice([-1, 1]) * size)
    elif kind == "radius":
        triple[2] = random.choice(["0", "-" + triple[2], "1e-60"]) if triple[2] != "0" else "1e-9"
    elif kind == "slope":
        triple = random.choice(tiles)["nodes"][0][-1]
        triple[1] = repr(
            float(triple[1]) * (1 + random.choice([-1, 1]) * 10.0 ** random.uniform(-1, 1)) + 1e-3
        )
    elif kind == "width":
        tile = random.choice(tiles)
        tile["half_width"] = repr(float(tile["half_width"]) * random.choice([0.0, 0.5, 30.0]))
    elif kind == "missing":
        del wrong["boxes"][random.integers(1, len(wrong["boxes"]) - 1)]
    elif kind == "end":  # one orbit on both sides of a tile, which is right for a stretch's first tile
        i = 2 * random.integers(int(special is None), len(tiles))
        wrong["boxes"][i] = copy.deepcopy(wrong["boxes"][i + 2])
    elif kind == "exponent":
        moved = [entry for entry in wrong["parameters"].values() if entry[2] != "0"]
        entry = moved[0] if moved else wrong["parameters"]["friction"]
        entry[2] = str(random.choice([k for k in ("0", "1", "-1", "2", "3", "0.5") if k != entry[2]]))
    elif kind == "kind":
        names = ["fold", "symmetry-breaking", "period-doubling", "neimark-sacker", "border", "stick", "user"]
        tiles[0]["kind"] = str(random.choice([name for name in names if name != special]))
    elif kind == "condition":
        ((what, i, side),) = wrong["boxes"][1]["conditions"]
        others = [
            ["wall" if what == "flight" else "flight", i, side],
            [what, (i + 1) % len(wrong["events"]), side],
        ]
        wrong["boxes"][1]["conditions"] = [[], [others[0]], [others[1]], [[what, i, side], others[1]]][
            random.integers(4)
        ]
    elif kind == "parameter":
        name = str(
            random.choice([n for n, entry in wrong["parameters"].items() if entry[2] == "0" and n in FELT])
        )
        size = float(wrong["parameters"][name][0]) * 10.0 ** random.uniform(-9, -1)
        wrong["parameters"][name][0] = repr(float(wrong["parameters"][name][0]) + size)
    elif kind == "letter":
        i = random.integers(len(wrong["events"]))
        other = random.choice([letter for letter in LETTERS if letter != wrong["events"][i]])
        wrong["events"] = wrong["events"][:i] + other + wrong["events"][i + 1 :]
    elif kind == "mode":
        i = random.integers(len(wrong["modes"]))
        wrong["modes"][i] = int(random.choice([m for m in (-1, 0, 1) if m != wrong["modes"][i]]))
    elif kind == "half":  # a different value means a different closing of the word
        wrong[kind] = [not wrong[kind], 2, -1, 0.5][random.integers(4)]
    elif kind == "frictionless":
        wrong[kind] = not wrong[kind]
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


def trial(number, random):
    """Try one wrong input (every hundredth a certificate, every tenth a special point, else an orbit); return its kind, the input, and whether it passed."""
    if number % 100 == 0:
        papers = certificates()
        kind, wrong = wrong_certificate(papers[random.integers(len(papers))], random)
        return kind, wrong, verified(wrong)
    if number % 10 == 0:
        found = points()
        kind, wrong = wrong_point(found[random.integers(len(found))], random)
        return kind, wrong, false_point(wrong)
    sound = orbits()
    orbit = sound[random.integers(len(sound))]
    kind, wrong = wrong_input(arguments(orbit), random)
    return kind, wrong, false_proof(wrong, orbit.symmetric and bool(random.integers(2)))


def main(count, seed=7):
    """Do `count` trials; print the numbers of wrong inputs that were proved or verified."""
    random = np.random.default_rng(seed)
    found = 0
    for number in range(count):
        kind, wrong, bad = trial(number, random)
        if bad:
            found += 1
            print(number, kind, wrong, flush=True)
        if number % 1000 == 0:
            print(f"{number} tried, {found} false", flush=True)
    print(f"{count} wrong inputs, {found} false proofs")
    return found


if __name__ == "__main__":
    sys.exit(main(*(int(word) for word in sys.argv[1:])) > 0)
