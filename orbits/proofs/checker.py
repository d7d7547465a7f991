"""Check certificates of proofs with nothing but the certificate and mpmath's intervals, without code of the prover.
A chain of boxes: orbit, tile, orbit ... tile, orbit. In a box the unknowns (nodes, parameter) are m + s q + [-r, r], one
solution for every |q| <= h; r = 0 if q alone fixes an unknown, h = 0 for an orbit, which lies in the tiles next to it."""
import re
from typing import Any

import mpmath
import numpy as np

iv: Any = mpmath.iv
BOTH, SIDES, WALL, MIRROR = iv.mpf([-1, 1]), {1: "_left", -1: "_right"}, {"L": 1, "R": -1}, {"L": "R", "R": "L"}
MODES = {"L": [(1, -1)], "R": [(-1, 1)], "t": [(1, -1), (-1, 1)], "s": [(1, 0), (-1, 0)], "u": [(0, 1), (0, -1)]}
PAIRS = [(name + "_left", name + "_right") for name in ("restitution", "friction", "distance")]
ALL, OWN = {"mass_ratio", "gravity", "frequency", "slope"}, [{"amplitude", "restitution", "friction"},
    {"amplitude", *sum(PAIRS, ())}, {"forcing", "damping", "excitation", "restitution", "friction"}]
KEYS = {"format", "parameters", "events", "modes", "periods", "half", "frictionless", "boxes", "claims", "bits", "versions"}
BOX, CLAIMS = {"nodes", "parameter", "half_width", "basis", "kind", "conditions"}, {"existence", "real", "stable"}
FLIP, ZERO, ONE = {True: "symmetry-breaking", False: "period-doubling"}, ["0", "0", "0"], ["1", "0", "0"]
class Refused(ValueError): """The certificate does not prove what it claims."""
def need(holds, why):
    if not holds: raise Refused(why)
def number(text):
    need(re.fullmatch(r"-?[0-9]+(\.[0-9]+)?(e[+-]?[0-9]{1,4})?", text), f"{text!r} is no decimal number")
    return iv.mpf(text)
class Jet(dict):  # {0: value, unknown: derivative}, unknowns are 1, 2 ..., all entries intervals
    def of(self, value, slope): return Jet({u: slope * a for u, a in self.items()} | {0: value})
    def __add__(self, other): return Jet({u: self.get(u, 0) + jet(other).get(u, 0) for u in self | jet(other)})
    def __sub__(self, other): return self + jet(other) * -1
    def __pow__(self, k): return self.of(self[0] ** k, self[0] ** (k - 1) * k)
    def __truediv__(self, other): return self * jet(other) ** -1
    def __mul__(self, other):
        a, b = self, jet(other)
        return Jet({u: a.get(u, 0) * b[0] + (a[0] * b[u] if u in b else 0) for u in a | b} | {0: a[0] * b[0]})
def jet(x): return x if isinstance(x, Jet) else Jet({0: iv.mpf(x)})
def sin(x): return x.of(iv.sin(x[0]), iv.cos(x[0]))
def cos(x): return x.of(iv.cos(x[0]), -iv.sin(x[0]))
def exp(x): return x.of(iv.exp(x[0]), iv.exp(x[0]))
def sign(x): return True if x.a > 0 else False if x.b < 0 else None
def machine(c, parameter):
    """Numbers, constants times powers of the parameter: friction limit by mode, walls and restitution by side."""
    p = {name: (parameter ** number(k) if k != "0" else jet(1)) * (number(a) + BOTH * number(r))
         for name, (a, r, k) in c["parameters"].items()}
    weight, tilt = (p["mass_ratio"] + 1) * p["gravity"], p.get("slope", jet(0))
    p |= {"limit0": jet(0), "bias": weight * sin(tilt) * -1, "e": jet(0) if "amplitude" in p else p["mass_ratio"]}
    for s, side in SIDES.items():
        friction, r = (p.get(name + side, p.get(name)) for name in ("friction", "restitution"))
        p |= {f"limit{s}": weight * cos(tilt) * friction, f"bounce{s}": r, f"wall{s}": p.get("distance" + side, jet(1)) * s}
    return p | {"whole": p["e"] + 1}
def motion(p, letter, mode, x, phase, rates=5):
    """q1 = X sin + Y cos + rest + (y cos bt + z sin bt) exp(-dt), w = q1 - q2, v = q1 + e q2, with rates; q2'' const."""
    e, om, whole, wall, s, c, zero = p["e"], p["frequency"], p["whole"], WALL.get(letter), sin(x[0]), cos(x[0]), jet(0)
    t, pull, mass = (phase - x[0]) / om, (p[f"limit{mode}"] * mode - p["bias"]) * abs(mode) / whole, jet(1) if mode else whole
    X, Y, y, z, C, S, d, b = p.get("amplitude"), *[zero] * 7
    if not X:
        K, g, d = jet(1) - mass * om * om, e * p["damping"] * om, e * p["damping"] / (mass * 2)
        size, b = e * p["forcing"] / (K * K + g * g), (jet(1) / mass - d * d) ** iv.mpf(0.5)
        X, Y = size * (K + p["excitation"] * g * g), size * g * (p["excitation"] * K - 1)
    w0, (v0, v1) = p[f"wall{wall}"] if wall else x[1], x[2:] or (X * s, X * om * c)
    speed, rest = (x[1] if wall else v1) / whole, e * pull * -1
    if x[2:] and letter != "o":
        y = (v0 + e * w0) / whole - rest - X * s - Y * c
        z = (v1 - e * speed - om * (X * c - Y * s) + d * y) / b
        C, S = (exp(d * t * -1) * f(b * t) for f in (cos, sin))
    s, c, q, fall = sin(phase), cos(phase), [], [(v0 - w0) / whole + (speed + pull * t / 2) * t, speed + pull * t, pull]
    for _ in range(rates):
        q.append(X * s + Y * c + rest + y * C + z * S)
        X, Y, y, z, rest = om * Y * -1, om * X, b * z - d * y, b * y * -1 - d * z, zero
    return q, [a - f for a, f in zip(q, [*fall, zero, zero])] if mode else [w0, *[zero] * 4]
def flights(c, p, x, end):
    """For every flight: letter, mode, event at its end, mode after it, both nodes; the last ends at `end` or its image."""
    nodes, t, w = [x[j:j + c["n"]] for j in range(0, len(x) - 1, c["n"])], 1 - 2 * c["half"], p["wall1"] + p["wall-1"]
    end = [end[0] + iv.pi * c["periods"] * (2 - c["half"]), end[1] * t + w * c["off"], *(a * t for a in end[2:c["n"]])]
    return [(*word, node, y) for word, node, y in zip(c["word"], nodes, [*nodes[1:], end])]
def equations(c, flat, shift=0):
    """Residuals of an orbit; unknowns are numbered from 1, those of the node that closes the word from 1 + shift."""
    x, end = ([Jet({0: a, u: iv.mpf(1)}) for u, a in enumerate(flat, 1 + first)] for first in (0, shift))
    p, rows = machine(c, x[-1]), []
    for letter, mode, wall, after, node, y in flights(c, p, x, end) if c["events"] != "o" else []:
        (q, w), s = motion(p, letter, mode, node, y[0], 3), WALL.get(wall)
        v, speed = (p["whole"] * q[k] - p["e"] * w[k] for k in (0, 1))
        slip = p["whole"] * q[2] + p["bias"] - p[f"limit{after}"] * after if wall == "u" else w[1]
        rows += [w[0] - p[f"wall{s}"], speed + p[f"bounce{s}"] * w[1] - y[1]] if s else [slip, w[0] - y[1]]
        rows += [v - y[2], speed - y[3]] if y[2:] else []
    return rows
def proved(c, box):
    """The box in intervals, with exactly one solution: |Y F(m + s q)| + |1 - Y DF(box)| r < r (Krawczyk); else refused."""
    triples, n = [triple for node in [*box["nodes"], [box["parameter"]]] for triple in node], c["n"] * len(c["word"])
    m, s, r = zip(*([number(text) for text in triple] for triple in triples))
    h, free, kind = number(box["half_width"]), [u for u, b in enumerate(r, 1) if b > 0], box["kind"]
    need({*box} == BOX and [*map(len, box["nodes"])] == [c["n"]] * len(c["word"]), "nodes do not fit the word")
    need(len(free) == n if c["events"] != "o" else triples[:-1] == [ZERO] * n, "not as many unknowns as equations")
    orbit = h == 0 == r[-1] and not kind and all(b == 0 for b in s)
    need((h > 0 or orbit) and (kind == "border" or box["conditions"] == []), "neither an orbit nor a tile")
    q, hull = BOTH * h, [a + BOTH * (abs(b) * h + radius) for a, b, radius in zip(m, s, r)]
    p = machine(c, jet(hull[-1]))
    good = [p[name][0].a >= 0 for name in c["parameters"] if name != "slope"] + [p["frequency"][0].a > 0]
    good += [p[f"limit{s}"][0] == 0 if c["frictionless"] else p[f"limit{s}"][0].a > 0 for s in SIDES]
    need(all(good) and all(p[f"bounce{s}"][0].a > 0 and p[f"bounce{s}"][0].b <= 1 for s in SIDES), "a number is out of range")
    here, path, over = (equations(c, at) for at in (m, [a + b * q for a, b in zip(m, s)], hull))
    F = [f[0] + q * sum(g.get(u, 0) * b for u, b in enumerate(s, 1)) for f, g in zip(here, path)]
    near = [[float(row[u].mid) if u in row else 0.0 for u in free] for row in over]
    for j, y in zip(free, np.linalg.inv(near).tolist() if F else []):
        defect = [sum((a * row[u] for a, row in zip(y, over) if u in row), -iv.mpf(u == j)) for u in free]
        moved: Any = abs(sum(a * f for a, f in zip(y, F))) + sum(abs(d) * r[u - 1] for u, d in zip(free, defect))
        need(moved.b < r[j - 1].a, f"unknown {j} leaves its box")
    return box | {"flat": [*zip(m, s, r)], "q": q, "hull": hull}
def positive(c, p, s, letter, mode, wall, after, x, y):
    """Whether f > 0 in a flight: by mean value forms on cells; next to an end at which f vanishes, by a derivative's sign."""
    free, zeros = c["frictionless"], ({"t": 1, "u": 2}.get(letter, 0), wall in "ts") if mode else (0, after == s)
    start, end = (WALL[letter] == s, WALL[wall] == s) if free else zeros
    def rates(phase):
        q, w = motion(p, letter, mode, x, jet(phase))
        reserve = [p[f"limit{s}"] * s - p["bias"] - p["whole"] * q[2], *(p["whole"] * a * -1 for a in q[3:])]
        room = [p[f"wall{s}"] - w[0], *(a * -1 for a in w[1:])]
        return [a[0] * s for a in (room if free else w[1:] if mode else reserve)[:3]]
    cells = [(iv.mpf(0), iv.mpf(1))]
    for _ in range(4000):
        if not cells: return True
        low, high = cells.pop()
        here, over = (x[0][0] + (y[0] - x[0])[0] * part for part in ((low + high) / 2, iv.mpf([low.a, high.b])))
        value, f = rates(here)[0], rates(over)
        if value.b < 0: return False
        beside = (low == 0 and start and f[start].a > 0) or (high == 1 and end and sign(f[end] * (-1) ** end))
        if not beside and not sign(value + f[1] * (over - here) / p["frequency"][0]):
            cells += [(low, (low + high) / 2), ((low + high) / 2, high)]
def conditions(c, hull, wanted):
    """Verdicts (True, False, None) on the inequalities of a real motion in a box, of the wanted keys [name, event, side]."""
    x, p, found = [jet(a) for a in hull], machine(c, jet(hull[-1])), []
    for i, (letter, mode, wall, after, node, y) in enumerate(flights(c, p, x, x)):
        found += [sign((y[0] - node[0])[0])] if wanted(["duration", i, 0]) else []
        found += [sign((p[f"wall{s}"] - node[1])[0] * s) for s in SIDES if letter not in WALL and wanted(["wall", i, s])]
        sides = [s for s in SIDES if (c["frictionless"] or mode in (0, s)) and wanted(["flight", i, s])]
        found += [positive(c, p, s, letter, mode, wall, after, node, y) for s in sides]
    return found
def det(M):
    minors = (det([[*row[:j], *row[j + 1:]] for row in M[1:]]) * (-1) ** j for j in range(len(M)))
    return sum((a * minor for a, minor in zip(M[0], minors)), iv.zero) if M else iv.one
def solved(M, B):  # Cramer's rule: no pivots, so nothing is compared
    n, by = range(len(M)), 1 / det(M)
    return iv.matrix([[det([[*row[:i], b[j], *row[i + 1:]] for row, b in zip(M, B)]) * by for j in n] for i in n])
def spectrum(c, hull, basis) -> Any:
    """det(1 - A), det(1 + A) of the map A over the word; how many multipliers lie outside the circle (None: not proved)."""
    n, p, rows, loose = c["n"], machine(c, jet(hull[-1])), equations(c, hull, 10**6), not {*c["events"]} & {*WALL}
    if c["events"] == "o": return iv.mpf(1), iv.mpf(1), 0 if n == 2 or (p["e"] * p["damping"])[0].a > 0 else None
    basis = [[number(text) for text in row] for row in basis]
    for j, shift in enumerate([0, 1, -p["e"][0], 0][:n] if loose else []):
        basis[j][1] = iv.mpf(shift)  # the multiplier 1 of a free shift of w, with v + e w constant, is left out
    A = iv.matrix(basis)
    for i in range(0, len(rows), n):
        old, new = ([[row.get(at + j, iv.zero) for j in range(1, n + 1)] for row in rows[i:i + n]]
                    for at in (i, i + n if i + n < len(rows) else 10**6))
        A = solved(new, old) * A * -1
    A, kept = solved(basis, A.tolist()), [j for j in range(n) if j != 1 or not loose]
    A, k = iv.matrix([[A[i, j] for j in kept] for i in kept]), len(kept)
    H = [D - A.T * D * A for D in (iv.diag([-1] * outside + [1] * (k - outside)) for outside in range(k + 1))]
    counts = [outside for outside in range(k + 1) if all(sign(det(H[outside][:j, :j].tolist())) for j in range(1, k + 1))]
    return det((iv.eye(k) - A).tolist()), det((iv.eye(k) + A).tolist()), counts[0] if counts else None
def changed(c, tile, beside):
    """Whether the orbits on both sides of a tile differ exactly as they do at a special point of the tile's kind."""
    if tile["kind"] == "border":
        sides = [conditions(c, orbit["hull"], lambda key: key in tile["conditions"]) for orbit in beside]
        return sides in [[[a] * len(tile["conditions"] or "?") for a in pair] for pair in ([True, False], [False, True])]
    (minus, plus, k), (minus_, plus_, k_), (at1, at_1, _) = (spectrum(c, b["hull"], b["basis"]) for b in (*beside, tile))
    return {"fold": sign(minus * minus_) is False and beside[0]["parameter"] == beside[1]["parameter"],  # a turn
            FLIP[c["half"]]: sign(plus * plus_) is False and abs(at_1).b < iv.inf,  # the map is smooth in between
            "neimark-sacker": None not in (k, k_, sign(at1), sign(at_1)) and abs(k - k_) == 2}[tile["kind"]]
def verify(c):
    """Verify the certificate of an orbit, a special point or a stretch."""
    need({*c} == KEYS and c["format"] == "contvines certificate 3" and 64 <= c["bits"] <= 9000, "an old or unknown format")
    iv.prec, events, modes, half, data = c["bits"] + 64, c["events"], c["modes"], c["half"], {"slope": ZERO} | c["parameters"]
    last = (MIRROR.get(events[0], events[0]), -modes[0]) if half else (events[0], modes[0])
    word: Any = [(*now, *then) for now, then in zip(zip(events, modes, strict=True), [*zip(events[1:], modes[1:]), last])]
    allowed = [(a, b) in MODES[wall] or (c["frictionless"] and b == -WALL[wall]) for _, a, wall, b in word if events != "o"]
    need(all(allowed) and (events != "o" or (modes, half, c["periods"]) == ([0], False, 1)), "no machine has this word")
    need({*data} in [ALL | own for own in OWN] and c["periods"] == int(c["periods"]) > 0, "no such numbers")
    alike = all(data.get(a) == data.get(b) and data.get(a, ZERO)[1] == "0" for a, b in PAIRS[:2])
    need(half in (0, 1) and (not half or (alike and data.get("slope", ZERO) == ZERO and c["periods"] % 2)), "no mirror")
    c |= {"n": 2 if "amplitude" in data else 4, "word": word, "off": int(half and events[0] not in WALL)}
    boxes, claims = [proved(c, box) for box in c["boxes"]], c["claims"]
    orbits, tiles, steady, kinds = boxes[::2], boxes[1::2], claims["stable"], [box["kind"] for box in boxes[1::2] or boxes]
    need(len(orbits) == len(tiles) + 1 and all(box["q"] == 0 for box in orbits), "no chain of orbits and tiles")
    need(tiles or (boxes[0]["parameter"] == ONE and all(k == "0" for *_, k in data.values())), "a parameter without use")
    need({*claims} == CLAIMS and claims["existence"] is True and (steady is None or not all(kinds)), "claims of nothing")
    for tile, orbit in [*zip(tiles, orbits), *zip(tiles, orbits[1:])]:
        at, = (j for j, (_, b, r) in enumerate(tile["flat"]) if r == 0 and b != 0)
        q = (orbit["hull"][at] - tile["flat"][at][0]) / tile["flat"][at][1]
        inside = [abs(x - m - b * q).b < r.a for x, (m, b, r) in zip(orbit["hull"], tile["flat"]) if r != 0]
        need(all(inside) and abs(q).b <= tile["q"].b, "an orbit lies outside its tile")
    for box, kind, *beside in zip(tiles or orbits, kinds, orbits, orbits[1:] or orbits):
        need(not kind or changed(c, box, beside), "nothing special happens in a tile")
        found = conditions(c, box["hull"], lambda key, box=box: key not in box["conditions"])
        need(claims["real"] in (None, True if all(found) else False if False in found else None), "not real or virtual")
        *ends, k = (iv.one, iv.one, None) if kind or steady is None else spectrum(c, box["hull"], box["basis"])
        need(kind or steady is (False if k or False in map(sign, ends) else True if k == 0 else None), "stability")
def check(c):
    """Verify a certificate, or a list of them; raise `Refused` for any defect."""
    try:
        for one in c if c and isinstance(c, list) else [c]: verify({**one})
    except (LookupError, TypeError, AttributeError, ArithmeticError, ValueError) as error:
        raise Refused(str(error) or "its intervals do not decide") from None
