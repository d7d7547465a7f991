# fmt: off
"""Certificates checked anew with nothing but the certificate and mpmath's intervals; none of the prover's code is used.

A certificate is a chain of boxes: orbit, tile, orbit ... tile, orbit. In a box the unknowns (nodes, then the parameter) are m + s q + [-r, r]
for |q| <= h, one solution for every q; r = 0 where q alone fixes an unknown, h = 0 for an orbit. A tile holds the orbits beside it, so all lie
on one branch. Tiles are real and stable as claimed; the orbits beside a special one differ so that the special point must lie between."""
import math
import re
from typing import Any

import mpmath
import numpy as np

iv: Any = mpmath.iv
VALUE, WALL, MIRROR, SIDES = (0, 0), {"L": 1, "R": -1}, {"L": "R", "R": "L"}, {1: "_left", -1: "_right"}
MODES = {"L": [(1, -1)], "R": [(-1, 1)], "t": [(1, -1), (-1, 1)], "s": [(1, 0), (-1, 0)], "u": [(0, 1), (0, -1)],
         "o": [(0, 0)]}  # before and after an event; o is none, the absorber is stuck for ever
PAIRS = [(name + "_left", name + "_right") for name in ("restitution", "friction", "distance")]
OWN = {"absorber": ["amplitude", "restitution", "friction"], "cavity": ["amplitude", "slope", *sum(PAIRS, ())],
       "coupled": ["forcing", "damping", "excitation", "restitution", "friction"]}

class Refused(ValueError): """The certificate does not prove what it claims."""

def need(holds, why):
    if not holds:
        raise Refused(why)

def number(text):
    need(re.fullmatch(r"-?\d+(\.\d+)?(e[+-]?\d+)?", text), f"{text!r} is no decimal number")
    return iv.mpf(text)

def jet(x): return x if isinstance(x, Jet) else Jet({VALUE: iv.mpf(x)})

class Jet(dict):
    """A power series in time with derivatives in the unknowns 1, 2 ...: {(power, unknown or 0): interval}."""
    def __add__(self, other) -> Any: return Jet({key: self.get(key, 0) + jet(other).get(key, 0) for key in self | jet(other)})
    def __sub__(self, other) -> Any: return self + jet(other) * -1
    def __truediv__(self, other) -> Any: return self * power(jet(other), -1)
    def dot(self) -> Any: return Jet({(t - 1, u): a * t for (t, u), a in self.items() if t})
    def __mul__(self, other) -> Any:
        out = Jet()
        for (s, u), a in self.items():
            for (t, v), b in jet(other).items():
                if s + t < 5 and not (u and v):
                    out[s + t, u + v] = out.get((s + t, u + v), 0) + a * b
        return out

    def of(self, derivatives) -> Any:
        """A function, by Taylor's series about the value; powers of all else vanish from the sixth on."""
        rest, total, term = Jet({key: a for key, a in self.items() if key != VALUE}), Jet(), jet(1)
        for k, f in enumerate(derivatives(self.get(VALUE, iv.mpf(0)))):
            total, term = total + term * (f / math.factorial(k)), term * rest
        return total

def sin(x): return x.of(lambda a: ([iv.sin(a), iv.cos(a), -iv.sin(a), -iv.cos(a)] * 2)[:6])
def cos(x): return sin(x + iv.pi / 2)
def exp(x): return x.of(lambda a: [iv.exp(a)] * 6)
def power(x, k): return x.of(lambda a: [a ** (k - j) * math.prod(k - i for i in range(j)) for j in range(6)])

def machine(c, parameter):
    """All numbers: constants times powers of the parameter; friction's limit by mode, the walls by side."""
    p = {name: (power(parameter, k) if k else jet(1)) * (number(a) + iv.mpf([-1, 1]) * abs(number(r)))
         for name, (a, r, k) in c["parameters"].items()}
    weight, tilt = (p["mass_ratio"] + 1) * p["gravity"], p.get("slope", Jet())
    p |= {"limit0": Jet(), "bias": weight * sin(tilt) * -1, "e": p["mass_ratio"] if c["n"] == 4 else Jet()}
    for side, name in SIDES.items():
        p[f"limit{side}"] = weight * cos(tilt) * p.get("friction" + name, p.get("friction"))
        p[f"wall{side}"] = p.get("distance" + name, jet(1)) * side
        p[f"bounce{side}"] = p.get("restitution" + name, p.get("restitution"))
    return p

def motion(p, letter, mode, x, phase):
    """Series of w = q1 - q2 and v = q1 + e q2 in the time after a phase of the flight that starts at node x.

    The oscillator q1 has a forced part X sin + Y cos, a free and a constant one, the absorber q2 falls; a shaken cavity has e = 0, q1 = C sin."""
    e, om, whole, wall = p["e"], p["frequency"], p["e"] + 1, WALL.get(letter)
    X, Y, drag, mass = p.get("amplitude"), Jet(), e * p.get("damping", 0), jet(1) if mode else whole
    if not X:
        K, g = jet(1) - mass * om * om, drag * om
        size = e * p["forcing"] / (K * K + g * g)
        X, Y = size * (K + p["excitation"] * g * g), size * g * (p["excitation"] * K - 1)
    s, c, angle, t = sin(x[0]), cos(x[0]), om * Jet({(1, 0): iv.mpf(1)}) + phase, (phase - x[0]) / om + Jet({(1, 0): iv.mpf(1)})
    q, w0, (v0, v1) = X * sin(angle) + Y * cos(angle), p[f"wall{wall}"] if wall else x[1], x[2:] or (X * s, X * om * c)
    pull, speed = (p[f"limit{mode}"] * mode - p["bias"]) / whole, (x[1] if wall else v1) / whole
    if x[2:] and letter != "o":
        z, u, decay = (v0 + e * w0) / whole + e * pull - X * s - Y * c, v1 - e * speed - om * (X * c - Y * s), drag / (mass * 2)
        be = power(jet(1) / mass - decay * decay, iv.mpf(1) / 2)
        q += exp(decay * t * -1) * (z * cos(be * t) + (u + decay * z) / be * sin(be * t)) - e * pull
    fall = (v0 - w0) / whole + speed * t + pull * t * t * (iv.mpf(1) / 2)
    return (q - fall, q + e * fall) if mode else (w0, whole * q - e * w0)

def flights(c, x, end):
    """Of every flight: letter, mode, the event after it and the mode then, both nodes; `end` is the node that closes the word."""
    nodes, n = [x[j:j + c["n"]] for j in range(0, len(x) - 1, c["n"])], len(c["events"])
    nodes.append([end[0] + c["span"], *(a * (-1 if c["half"] else 1) for a in end[1:])])
    return [(c["events"][i], c["modes"][i], *c["arrivals"][i], nodes[i], nodes[i + 1]) for i in range(n)]

def equations(c, flat, shift=0):
    """Rows {unknown: derivative, 0: value}; unknowns are numbered from 1, those of the node that closes the word from 1 + shift."""
    x, end = ([Jet({VALUE: a, (0, u): iv.mpf(1)}) for u, a in enumerate(flat, 1 + first)] for first in (0, shift))
    p, rows = machine(c, x[-1]), []
    for letter, mode, wall, after, node, y in flights(c, x, end[:c["n"]]) if c["events"] != "o" else []:
        (w, v), side = motion(p, letter, mode, node, y[0]), WALL.get(wall)
        if side:
            rows += [w - p[f"wall{side}"], v.dot() + p[f"bounce{side}"] * w.dot() - y[1]]
        else:
            rows += [v.dot().dot() + p["bias"] - p[f"limit{after}"] * after if wall == "u" else w.dot(), w - y[1]]
        rows += [v - y[2], v.dot() - y[3]] if y[2:] else []
    return [{u: a for (t, u), a in row.items() if t == 0} for row in rows]

def exists(c, box):
    """Exactly one solution for every q: |Y F(m + s q)| + |1 - Y DF(box)| r < r with some Y (Krawczyk); here it is near the inverse."""
    (m, s, r), q, over = zip(*box["flat"]), box["q"], equations(c, box["hull"])
    free, slopes = [j for j, b in enumerate(r, 1) if b != 0], equations(c, [a + b * q for a, b in zip(m, s)])
    F = [f.get(0, 0) + q * sum(g.get(j, 0) * b for j, b in enumerate(s, 1)) for f, g in zip(equations(c, m), slopes)]
    need(len(F) == len(free), "there are not as many equations as unknowns")
    middle = [[float(row[j].mid) if j in row else 0.0 for j in free] for row in over]
    for j, y in zip(free, np.linalg.inv(middle).tolist() if F else []):
        defect = {j: iv.mpf(-1)}
        for weight, row in zip(y, over):
            defect |= {u: defect.get(u, 0) + weight * row[u] for u in row.keys() & set(free)}
        moved = abs(sum(weight * f for weight, f in zip(y, F))) + sum(abs(a) * r[u - 1] for u, a in defect.items())
        need(moved < r[j - 1], f"unknown {j} leaves its box")

def positive(rates, first, last, start, end, pace):
    """Whether f > 0 between two phases: by mean values on cells, and beside an end at which k rates of f vanish by the k-th."""
    cells = [(iv.mpf(0), iv.mpf(1))]
    for _ in range(4000):
        if not cells:
            return True
        low, high = cells.pop()
        here, over = (first + (last - first) * part for part in ((low + high) / 2, iv.mpf([low.a, high.b])))
        value, f = rates(here)[0], rates(over)
        if value < 0:
            return False
        beside = (low == 0 and start and f[start] > 0) or (high == 1 and end and f[end] * (-1) ** end > 0)
        if not beside and not value + f[1] * (over - here) * pace > 0:
            cells += [(low, (low + high) / 2), ((low + high) / 2, high)]

def conditions(c, box, wanted):
    """Whether inequalities of a real motion hold throughout the box: {(what, event, side): True, False or None}."""
    x, p, found = [jet(a) for a in box["hull"]], machine(c, jet(box["hull"][-1])), {}
    for i, (letter, mode, wall, after, node, y) in enumerate(flights(c, x, x[:c["n"]])):
        tests = {("duration", i, 0): (y[0] - node[0])[VALUE]}
        tests |= {("wall", i, s): (p[f"wall{s}"] - node[1])[VALUE] * s for s in SIDES if letter in "tsuo"}
        found |= {key: True if value > 0 else False if value < 0 else None for key, value in tests.items()}
        sides = [1] if letter == "o" and "slope" not in p else SIDES  # stuck for ever: the other side is the mirror image
        for s in sides if c["frictionless"] or mode == 0 else (mode,):
            def rates(phase, letter=letter, mode=mode, node=node, s=s):
                w, v = motion(p, letter, mode, node, jet(phase))
                f = w.dot() * s if mode else p[f"limit{s}"] - (v.dot().dot() + p["bias"]) * s
                f = (p[f"wall{s}"] - w) * s if c["frictionless"] else f
                return [f.get((k, 0), iv.mpf(0)) * math.factorial(k) for k in range(3)]
            start, end = {"t": 1, "u": 2}.get(letter, 0), wall in "ts" if mode else after == s
            zeros = (WALL[letter] == s, WALL[wall] == s) if c["frictionless"] else (start, end)
            if wanted(["flight", i, s]):
                found["flight", i, s] = positive(rates, node[0][VALUE], y[0][VALUE], *zeros, (jet(1) / p["frequency"])[VALUE])
    return {key: holds for key, holds in found.items() if wanted([*key])}

def spectrum(c, box):
    """Whether all multipliers lie inside the unit circle; det(1 - A) and det(1 + A) of their matrix A, in the basis that is given; how many
    are known to lie outside, all others inside: D - A'DA is positive definite with so many -1 in D = diag(-1 .. 1 ..)."""
    n, p, rows, loose = c["n"], machine(c, jet(box["hull"][-1])), equations(c, box["hull"], 10**6), not set(c["events"]) & set(WALL)
    if c["events"] == "o":
        return n == 2 or (p["e"] * p["damping"]).get(VALUE, 0) > 0 or None, iv.mpf(1), iv.mpf(1), 0
    A = basis = iv.matrix([[number(text) for text in row] for row in box["basis"]])
    for j, shift in enumerate([0, 1, p["e"].get(VALUE, iv.mpf(0)) * -1, 0][:n] if loose else []):
        basis[j, 1] = shift  # w may be shifted, with v + e w kept: that multiplier is left out
    for i in range(0, len(rows), n):
        old, new = (iv.matrix([[row.get(j, 0) for j in range(first + 1, first + n + 1)] for row in rows[i:i + n]])
                    for first in (i, i + n if i + n < len(rows) else 10**6))
        A = new**-1 * old * A * -1
    A, kept = basis**-1 * A, [j for j in range(n) if j != 1 or not loose]
    A, one, pairs = iv.matrix([[A[i, j] for j in kept] for i in kept]), iv.eye(len(kept)), [(i, j) for j in range(len(kept)) for i in range(j)]
    minors = [[int((i, j) == (k, m)) - A[i, k] * A[j, m] + A[i, m] * A[j, k] for k, m in pairs] for i, j in pairs]
    minus, plus, D = iv.det(one - A), iv.det(one + A), [iv.diag([-1] * k + [1] * (len(kept) - k)) for k in range(len(kept) + 1)]
    counts = [k for k, H in enumerate(D) if all(iv.det((H - A.T * H * A)[:j, :j]) > 0 for j in range(1, len(kept) + 1))]
    outside = minus < 0 or plus < 0 or (pairs and iv.det(iv.matrix(minors)) < 0)  # the product of all 1 - mu_i mu_j
    return True if 0 in counts else False if outside or counts else None, minus, plus, counts[0] if counts else None

def changed(c, tile, one, other):
    """Whether the orbits on both sides of a tile differ as they do about a special point of its kind."""
    kind, (_, minus, plus, k), (_, minus_, plus_, k_) = tile["kind"], spectrum(c, one), spectrum(c, other)
    if kind == "border":
        sides = [conditions(c, box, lambda key: key == tile["condition"]) for box in (one, other)]
        return [{*side.values()} for side in sides] in ([{True}, {False}], [{False}, {True}])
    if kind == "neimark-sacker":
        return k is not None and k_ is not None and abs(k - k_) == 2 and all(0 not in value for value in spectrum(c, tile)[1:3])
    if kind == "fold":
        return one["parameter"] == other["parameter"] and minus * minus_ < 0
    return kind == ("symmetry-breaking" if c["half"] else "period-doubling") and plus * plus_ < 0

def unfolded(c, box):
    """The box in intervals; the machine's numbers are within their bounds, and the solution exists."""
    flat = [[number(text) for text in triple] for node in [*box["nodes"], [box["parameter"]]] for triple in node]
    h, both = abs(number(box["half_width"])), iv.mpf([-1, 1])
    box = box | {"flat": flat, "q": both * h, "hull": [m + both * (abs(s) * h + r) for m, s, r in flat]}
    p, fits = machine(c, jet(box["hull"][-1])), [len(node) == c["n"] for node in box["nodes"]]
    need(all(fits) and len(fits) == len(c["events"]) and all(r >= 0 for *_, r in flat), "nodes do not fit the word")
    need(all(p[name].get(VALUE, 0) >= 0 for name in c["parameters"] if name != "slope") and p["frequency"][VALUE] > 0, "out of range")
    for limit, r in ((p[f"limit{s}"][VALUE], p[f"bounce{s}"][VALUE]) for s in SIDES):
        need((limit == 0 if c["frictionless"] else limit > 0) and r > 0 and r <= 1, "friction or restitution is out of range")
    exists(c, box)
    return box

def verify(c):
    """Verify a certificate (a dict, as from JSON); raises `Refused` where it does not prove its claims."""
    if c["kind"] == "branch":
        return [verify(piece) for piece in c["pieces"]]
    need(c["format"] == "contvines certificate 2" and 64 <= c["bits"] <= 9000, "not a certificate of this format")
    iv.prec, events, modes, half, given = c["bits"] + 64, c["events"], c["modes"], c["half"], c["parameters"]
    last = (MIRROR.get(events[0], events[0]), -modes[0]) if half else (events[0], modes[0])
    c = c | {"n": 4 if c["machine"] == "coupled" else 2, "arrivals": [*zip(events[1:], modes[1:]), last],
             "span": iv.pi * c["periods"] * (1 if half else 2)}
    need(len(events) == len(modes) and c["periods"] > 0 and c["periods"] == int(c["periods"]), "word or periods")
    for before, (wall, after) in zip(modes, c["arrivals"]):
        need((before, after) in MODES[wall] or (c["frictionless"] and after == -WALL[wall]), "no machine has this word")
    need({*given} == {*OWN[c["machine"]], "mass_ratio", "gravity", "frequency"}, "parameters are missing, or too many")
    if half:
        alike = [given[a] == given[b] and given[a][1] == "0" for a, b in PAIRS] if c["machine"] == "cavity" else []
        need(events != "o" and c["periods"] % 2 and all(alike) and (not alike or given["slope"] == ["0", "0", 0]), "no mirror symmetry")
    boxes, claims, kinds = [unfolded(c, box) for box in c["boxes"]], c["claims"], [box.get("kind") for box in c["boxes"]]
    alone, single = len(boxes) == 3 and kinds[1], len(boxes) == 1  # a special point by itself, an orbit
    need(c["kind"] == ("orbit" if single else alone or "piece") and len(boxes) % 2 and not any(kinds[::2]), "no such kind")
    need(claims["stable"] is None if alone else len(boxes) == 1 or None in kinds[1::2], "nothing but special points")
    for i, (box, kind) in enumerate(zip(boxes, kinds)):
        need(i % 2 or box["q"] == 0, "an orbit has no width")
        for orbit in boxes[i - 1:i + 2:2] if i % 2 else []:  # lies in the tile
            at, = (j for j, (_, s, r) in enumerate(box["flat"]) if r == 0 and s != 0)
            q = (orbit["hull"][at] - box["flat"][at][0]) / box["flat"][at][1]
            within = [abs(x - m - s * q) < r for x, (m, s, r) in zip(orbit["hull"], box["flat"]) if r != 0]
            need(all(within) and abs(q) <= box["q"].b, "an orbit lies outside its tile")
        need(not kind or (i in (1, len(boxes) - 2) and changed(c, box, *boxes[i - 1:i + 2:2])), "nothing special happens in a tile")
        if i % 2 or len(boxes) == 1:
            border = box.get("condition") if kind == "border" else None
            found = conditions(c, box, lambda key, border=border: key != border).values()
            need(claims["real"] in (None, True if all(found) else False if False in found else None), "not proved real, or virtual")
            need(claims["stable"] is None or kind or spectrum(c, box)[0] is claims["stable"], "not proved stable, or unstable")

def check(c):
    """Verify a certificate whatever is wrong with it."""
    try:
        verify(c)
    except (LookupError, TypeError, AttributeError, ArithmeticError, ValueError) as error:
        raise Refused(str(error)) from None
