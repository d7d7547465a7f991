# fmt: off
"""Certificates checked anew, with nothing but the certificate and mpmath's intervals; none of the prover's code is used.

The equations of motion are in `motion`; all else follows from w and v there. Numbers are truncated power series in time, in the
directions of eigenvectors and in the unknowns, {(power of time, direction, unknown): interval}: coefficients are derivatives."""
import math
from typing import Any

import mpmath

iv: Any = mpmath.iv
WALL, ZERO, MIRROR = {"L": 1, "R": -1}, (0, 0, 0), {"L": "R", "R": "L"}
OWN = {"absorber": "amplitude restitution friction", "coupled": "forcing damping restitution excitation friction",
       "cavity": "amplitude slope " + " ".join(f"{name}_{s}" for name in ("restitution", "friction", "distance") for s in ("left", "right"))}
FITS = {"L": ((1,), (-1,)), "R": ((-1,), (1,)), "t": ((1, -1), (1, -1)), "s": ((1, -1), (0,)), "u": ((0,), (1, -1))}

class Refused(ValueError):
    """The certificate does not prove what it claims."""

def need(holds, why):
    if not holds: raise Refused(why)

def num(text):
    mid, rad = (text, "0") if isinstance(text, str) else text
    need(iv.mpf(str(rad)) >= 0, "a radius is negative")
    return iv.mpf(str(mid)) + iv.mpf([-1, 1]) * iv.mpf(str(rad))

class A:
    def __init__(self, c): self.c = c if isinstance(c, dict) else {ZERO: iv.mpf(c)}
    def __call__(self): return self.c.get(ZERO, iv.mpf(0))
    def __sub__(self, o): return self + o * -1
    def __truediv__(self, o): return self * (o.f("inv") if isinstance(o, A) else 1 / iv.mpf(o))
    def rate(self, k) -> Any: return A({(0, d, v): x * math.factorial(k) for (t, d, v), x in self.c.items() if t == k})
    def __add__(self, o):
        o = (o if isinstance(o, A) else A(o)).c
        return A({k: self.c[k] + o[k] if k in o and k in self.c else self.c.get(k, o.get(k)) for k in self.c | o})
    def __mul__(self, o):
        out, o = {}, o if isinstance(o, A) else A(o)
        for ((t, d, v), a), ((s, e, w), b) in ((x, y) for x in self.c.items() for y in o.c.items()):
            if t + s < 4 and not (d and e) and not (v and w):
                out[key] = out.get(key := (t + s, d or e, v or w), 0) + a * b
        return A(out)
    __radd__, __rmul__ = __add__, __mul__
    def f(self, name):  # sum of f^(k)(a)/k! (self - a)^k, finite since powers are truncated
        a, out, power, k, c = self(), A(0), A(1), 0, None
        rest, sines = A({key: x for key, x in self.c.items() if key != ZERO}), name in ("sin", "cos")
        wave = [iv.sin(a), iv.cos(a), -iv.sin(a), -iv.cos(a)] * 2 if sines else [iv.exp(a)] if name == "exp" else []
        while power.c:
            if wave: c = wave[(k % 4 + (name == "cos")) * sines] / math.factorial(k)
            elif k: c = c * ((-1 if name == "inv" else iv.mpf(3) / (2 * k) - 1) / a)  # the powers -1 and 1/2
            else: c = 1 / a if name == "inv" else iv.sqrt(a)
            out, power, k = out + power * c, power * rest, k + 1
        return out

def response(p, mass):  # q1 = X sin + Y cos under the forcing; decay and frequency of its free motion
    e, om, chi, g = p["mass_ratio"], p["frequency"], p["excitation"], p["mass_ratio"] * p["damping"] * p["frequency"]
    K, al = om * om * mass * -1 + 1, e * p["damping"] / (mass * 2)
    n = e * p["forcing"] / (K * K + g * g)
    return n * (K + chi * g * g), n * g * (chi * K - 1), al, (A(1) / mass - al * al).f("sqrt")

def motion(p, letter, mode, x, phase):
    """Series of w and v in the time after `phase`, on the flight that starts at node x; no letter: stuck for ever."""
    om, e, T = p["frequency"], p["mass_ratio"], A({(1, 0, 0): iv.mpf(1)})
    s, c, C = (om * T + phase).f("sin"), (om * T + phase).f("cos"), p.get("amplitude")
    if not letter:
        X, Y = (C, 0) if C else response(p, e + 1)[:2]
        return A(0), (X * s + Y * c) * (A(1) if C else e + 1)
    t, w0, s0, c0 = (phase - x[0]) / om + T, p["d", WALL[letter]] * WALL[letter] if letter in WALL else x[1], x[0].f("sin"), x[0].f("cos")
    if C:
        b = x[1] if letter in WALL else C * om * c0
        return (w0 + C * s - C * s0 - b * t + (p["bias"] - p["a", mode] * mode) * t * t / 2 if mode else w0), C * s
    k1, pull = (x[1] if letter in WALL else x[3]) / (e + 1), p["friction"] * p["gravity"] * mode
    X, Y, al, be = response(p, A(1) if mode else e + 1)
    z, u = (x[2] + e * w0) / (e + 1) + e * pull - X * s0 - Y * c0, x[3] - e * k1 if letter in WALL else k1
    u = u - om * (X * c0 - Y * s0)
    q = X * s + Y * c - e * pull + (al * t * -1).f("exp") * (z * (be * t).f("cos") + (u + al * z) / be * (be * t).f("sin"))
    k = (x[2] - w0) / (e + 1) + k1 * t + pull * t * t / 2
    return (q - k, q + e * k) if mode else (w0, q * (e + 1) - e * w0)

def finish(p):  # the bias by the slope; friction's limit a and the wall's distance d on either side
    weight, tilt, p = (p["mass_ratio"] + 1) * p["gravity"], p.get("slope", A(0)), p | {("a", 0): A(0)}
    for s, side in ((1, "_left"), (-1, "_right")):
        p["a", s] = weight * (p["friction" + side] if "slope" in p else p["friction"]) * tilt.f("cos")
        p["d", s] = p["distance" + side] if "slope" in p else A(1)
    return p | {"bias": weight * tilt.f("sin") * -1}

def closed(c, x, angle=None):  # the first node as it must be after the last flight, its directions times the multiplier
    out, one = [], iv.mpf(1)
    for j, y in enumerate(x):
        a, b, d = (A({(t, 0, v): x for (t, d, v), x in y.c.items() if d == k}) for k in range(3))
        if angle: b, d = angle.f("cos") * b - angle.f("sin") * d, angle.f("sin") * b + angle.f("cos") * d
        y = a + b * A({(0, 1, 0): one * c.get("multiplier", 1)}) + d * A({(0, 2, 0): one})
        out.append(y * c["sign"] if j else y + iv.pi * c["periods"] * (1 if c["half"] else 2))
    return out

def equations(c, p, z, e, shift=1):
    """Rows {0: value, unknown: derivative}; the closing node's unknowns are numbered from `shift`, others from 1."""
    n, k, size = c["n"], len(z[0]), len(z) * len(z[0]) + len(e)
    def node(i, shift=1):
        x = [A({ZERO: z[i][j], (0, 0, i * k + j + shift): iv.mpf(1)}) for j in range(min(n, k))]
        for j in range(n, k): x[j % n] += A({(0, j // n, 0): z[i][j], (0, j // n, i * k + j + shift): iv.mpf(1)})
        return x
    ext, out = [A({ZERO: v, (0, 0, 1 + size - len(e) + j): iv.mpf(1)}) for j, v in enumerate(e)], []
    p = finish(p | ({c["parameter"]: ext[0]} if e else {}))
    for i, letter in enumerate(c["events"]):
        y = node(i + 1) if i + 1 < len(z) else closed(c, node(0, shift), ext[1] if k == 3 * n else None)
        (w, v), wall = motion(p, letter, c["signs"][i], node(i), y[0]), c["letters"][i + 1]
        r = p.get("restitution", p.get("restitution_left" if wall == "L" else "restitution_right"))
        out += [w.rate(0) - p["d", WALL[wall]] * WALL[wall], v.rate(1) + r * w.rate(1) - y[1]] if wall in WALL else [
            v.rate(2) + p["bias"] - p["a", c["signs"][i + 1]] * c["signs"][i + 1] if wall == "u" else w.rate(1), w.rate(0) - y[1]]
        out += [v.rate(0) - y[2], v.rate(1) - y[3]] if n == 4 else []
    rows = [{v: x for (_, f, v), x in row.c.items() if f == d} for row in out for d in range(k // n or 1)]
    if "normal" in c:
        b, j = c["normal"]
        return rows + [{0: z[b][d * n + j] - (d == 1), 1 + b * k + d * n + j: iv.mpf(1)} for d in range(1, k // n)]
    if "border" not in c: return rows
    (name, i, side), x = c["border"], node(c["border"][1])
    w, v = motion(p, c["events"][i:i + 1], c["signs"][i], x, ext[1] if len(e) > 1 else x[0])
    push = p["a", side] - (v.rate(2) + p["bias"]) * side
    out = {"flight": [w.rate(1), w.rate(2)], "hold": [push, v.rate(3)], "slip": [v.rate(3)], "approach": [w.rate(1)], "rest": [v.rate(3), push],
           "reversal": [w.rate(0) * side - p["d", side], w.rate(1)], "wall": [w.rate(0) * side - p["d", side]]}.get(name, [push])
    return rows + [{v: x for (_, _, v), x in row.c.items()} for row in out]

def solve(rows, order):
    """Interval Gauss elimination of sparse rows {unknown: coefficient, 0: right side}."""
    pivots, x = [], {}
    need(len(rows) == len(order), "there are not as many equations as unknowns")
    for col in order:
        near = [row for row in rows if col in row and 0 not in row[col]]
        need(near, "the equations may be singular")
        pivot = max(near, key=lambda row: min(abs(row[col].a), abs(row[col].b)))
        rows = [row for row in rows if row is not pivot]
        for row in (row for row in rows if col in row):
            factor = row.pop(col) / pivot[col]
            for j in pivot.keys() - {col}: row[j] = row.get(j, 0) - factor * pivot[j]
        pivots.append((col, pivot))
    for col, pivot in reversed(pivots):
        x[col] = (pivot.get(0, iv.mpf(0)) - sum(b * x[j] for j, b in pivot.items() if j not in (0, col))) / pivot[col]
    return x

def exists(c, p, z, e):
    """The interval Newton operator maps the box into its interior."""
    k, last, flat = len(z[0]), len(z) * len(z[0]), [v for node in z for v in node] + e
    mid = [iv.mpf(v.mid) for v in flat]
    values = equations(c, p, [mid[i * k:i * k + k] for i in range(len(z))], mid[last:])
    rows = [row | {0: value.get(0, iv.mpf(0))} for row, value in zip(equations(c, p, z, e), values)]
    step = solve(rows, [*range(k + 1, last + 1), *range(1, k + 1), *range(last + 1, len(flat) + 1)])
    for j, (m, box) in enumerate(zip(mid, flat), start=1):
        need((m - step[j]).a > box.a and (m - step[j]).b < box.b, f"unknown {j} leaves its ball")

def conditions(c, p, z, name, event, side, touch):
    """Inequalities (name, event, number) and (name, event, (f and its rates, first, last, zeros at start and end, touching phase))."""
    (a, d), frame, signs = ({s: p[name, s]() for s in (1, -1)} for name in "ad"), [[A(v) for v in node] for node in z], c["signs"]
    def ws(ph, i, s): return [(motion(p, c["events"][i], signs[i], frame[i], A(ph))[0].rate(k) * s)() for k in range(4)]
    def push(ph, i):
        v = motion(p, c["events"][i], signs[i], frame[i], A(ph))[1]
        return (v.rate(2) + p["bias"])(), v.rate(3)()
    for i, letter in enumerate(c["events"]):
        mode, wall, j, first = signs[i], c["letters"][i + 1], (i + 1) % len(z), z[i][0]
        last, here, there = (frame[j] if j else closed(c, frame[0]))[0](), name if event == i else "", name if event == j else ""
        P = push(first, i)
        tests = [("approach", 0, ws(first, i, -WALL[letter])[1])] if letter in WALL else [("wall", s, d[s] - z[i][1] * s) for s in (1, -1)]
        tests += {"t": [("turn", 0, mode * P[0] - a.get(mode, 0))], "u": [("slip", 0, mode * P[1])],
                  "s": [("stick", s, a[s] - P[0] * s) for s in (1, -1)]}.get(letter, [])
        yield from ((n, i, v) for n, s, v in tests if here.replace("stop", "stick") != n or s not in (0, side))
        if here == "stop":  # no time at all: the push reaches friction at both ends, and once in their neighbourhood
            once = push(iv.mpf([min(first.a, last.a), max(first.b, last.b)]), i)[1] * signs[i + 1]
            yield "stop", i, once if 0 in last - first and side == signs[i + 1] else iv.mpf(-1)
            continue
        yield "duration", i, last - first
        if event == i and touch is not None: yield from (("touch", i, touch - first), ("touch", i, last - touch))
        for s in (1, -1) if mode == 0 or c["frictionless"] else (mode,):
            if c["frictionless"]:
                f: Any = lambda ph, i=i, s=s: [v + (k == 0) * d[s] for k, v in enumerate(ws(ph, i, -s))]  # noqa: E731
                kind, start, end = "wall", (WALL[letter] == s) * (1 + (here == "approach")), (WALL[wall] == s) * (1 + (there == "approach"))
            elif mode == 0:
                f = lambda ph, i=i, s=s: [a[s] - push(ph, i)[0] * s, push(ph, i)[1] * -s]  # noqa: E731
                kind, start, end = "hold", here == "stick" and side == s, s == signs[i + 1]
            else:
                f = lambda ph, i=i, s=s: ws(ph, i, s)[1:]  # noqa: E731
                kind, start = "flight", {"t": 1, "u": 2}.get(letter, 0) + (here in ("turn", "approach", "slip"))
                end = 2 if there == "stop" and side == mode else wall in "ts" or there == "approach"
            at = touch if here == {"wall": "reversal"}.get(kind, kind) and (kind == "flight" or side == s) else None
            yield kind, i, (f, first, last, int(start), int(end), at)

def positive(test, pace):
    """True: f > 0 is proved; False: its contrary somewhere; None."""
    if not isinstance(test, tuple): return True if test > 0 else False if test < 0 else None
    (f, first, last, start, end, touch), todo = test, [(iv.mpf(0), iv.mpf(1))]
    for _ in range(4000):
        if not todo: return True
        low, high = todo.pop()
        half, mid, over = (low + high) / 2, first + (last - first) * (low + high) / 2, first + (last - first) * iv.mpf([low.a, high.b])
        value, zero = f(mid)[0], touch is not None and not (over.b < touch.a or over.a > touch.b)
        if value < 0: return False
        rates = f(iv.mpf([min(over.a, touch.a), max(over.b, touch.b)]) if touch is not None and zero else over)
        ends = [(2, 1)] if zero else [(0, 1), (start * (low == 0), 1), (end * (high == 1), (-1) ** end if high == 1 else 1)]
        if not any(k < len(rates) and rates[k] * s > 0 for k, s in ends) and (zero or not value + rates[1] * (over - mid) * pace > 0):
            todo += [(low, half), (half, high)]

def steady(c, p, z, basis=()):
    """Whether all multipliers lie inside the unit circle, or one outside: by norm and trace of powers of their matrix."""
    n, size, e = c["n"], len(z) * c["n"], p["mass_ratio"]()
    rows = equations(c, p, z, [], size + 1)
    M, B = [[0] * n for _ in range(n)], [[num(x) for x in row] for row in basis] or [[iv.mpf(int(i == j)) for i in range(n)] for j in range(n)]
    for j in range(n):
        x = [row[j] for row in B]
        for i in range(len(z)):  # from node to node
            known, new = range(1 + i * n, 1 + i * n + n), range(1 + i * n + n, 1 + i * n + 2 * n)
            step = solve([{q: row[q] for q in row if q in new} | {0: -sum(row.get(q, iv.mpf(0)) * v for q, v in zip(known, x))}
                          for row in rows[i * n:i * n + n]], new)
            x = [step[q] for q in new]
        for i in range(n): M[i][j] = x[i]
    if not any(letter in WALL for letter in c["events"]):  # shifting w, v + eps w kept, changes nothing: a trivial multiplier
        need(c["half"], "a sliding motion is stable or not on half its word")
        if n == 4: M[2] = [x + e * y for x, y in zip(M[2], M[1])]
        M = [[row[0], *(row[j] for j in range(2, n))] for i, row in enumerate(M) if i != 1]
    if basis:  # the similar matrix in another basis
        X = [solve([dict(enumerate(row, 1)) | {0: M[i][j]} for i, row in enumerate(B)], [*range(1, n + 1)]) for j in range(n)]
        M = [[X[j][1 + i] for j in range(n)] for i in range(n)]
    for _ in range(26):
        if all(sum(abs(x) for x in row) < 1 for row in M): return True
        if abs(sum(M[i][i] for i in range(len(M)))) > len(M): return False
        M = [[sum(row[k] * M[k][j] for k in range(len(M))) for j in range(len(M))] for row in M]

def cover(c, p, length):
    """A piece of a branch: tiles m + s q + [-r, r] at p_c + q with one orbit each for every q, joined at common orbits."""
    n, claims, joints, end, last = c["n"], c["claims"], [*c["joints"], None], iv.mpf(c["covered"][0]).b, None
    for (center, half, nodes, basis), joint in zip(c["tiles"], joints, strict=True):
        (m, s, r), q, P = ([[[num(t[k]) for t in x] for x in nodes] for k in range(3)]), num(["0", half]), num([center, half])
        def box(q, wide, m=m, s=s, r=r):
            return [[a + b * q + d * iv.mpf([-1, 1]) * wide for a, b, d in zip(*row)] for row in zip(m, s, r)]
        here, size, flat = num([center, "0"]), n * length, [b for x in s for b in x]
        need(len(m) == length and all(len(x) == n for x in m) and P.a <= end, "the tiles leave a gap")
        move, rows = equations(c, p, box(q, 0), [P]), equations(c, p, box(q, 1), [P])
        for row, at, along in zip(rows, equations(c, p, m, [here]), move):
            slope = sum((along.get(1 + j, 0) * b for j, b in enumerate(flat)), along.get(1 + size, iv.mpf(0)))
            row.pop(1 + size, None)
            row[0] = at.get(0, iv.mpf(0)) + slope * q
        step = solve(rows, [*range(n + 1, size + 1), *range(1, n + 1)])
        need(all(abs(step[1 + j]) < d for j, d in enumerate(d for x in r for d in x)), "a solution leaves its tile")
        here, z = finish(p | {c["parameter"]: A(P)}), box(q, 1)
        found = [positive(test, 1 / here["frequency"]()) for _, _, test in conditions(c, here, z, "", -1, 0, None)]
        need(claims["real"] is None or (all(found) if claims["real"] else False in found), "a tile is not proved real, or virtual")
        fixed = p | {c["parameter"]: A(P)}
        need(claims["stable"] is None or steady(c, fixed, z, basis) is claims["stable"], "a tile is not proved stable, or unstable")
        for value, point in [x for x in (last, joint) if x]:
            at, x = num(value), [[num(t) for t in node] for node in point]
            need(at.a > P.a and at.b < P.b, "a joint lies outside its tile")
            exists(c, p | {c["parameter"]: A(at)}, x, [])
            inside = zip([v for node in x for v in node], [v for node in box(at - num([center, "0"]), 1) for v in node])
            need(all(a.a > b.a and a.b < b.b for a, b in inside), "a joint lies outside its tile")
        last, end = joint, P.b
    need(iv.mpf(c["covered"][1]).b <= end, "the tiles end too early")

def check(c):
    """Verify a certificate (a dict, as from JSON); raises `Refused` where it does not prove its claims."""
    try: verify(c)
    except (LookupError, TypeError, AttributeError, ArithmeticError, ValueError) as error: raise Refused(str(error)) from None

def verify(c):
    if c["kind"] == "branch": return [verify(piece) for piece in c["pieces"]]
    need(c["format"] == "contvines certificate 1" and 64 <= c["bits"] <= 9000, "not a certificate of this format")
    iv.prec, sign, half = c["bits"] + 64, -1 if c["half"] else 1, c["half"]
    (events, modes), first = (c["events"], c["modes"]), c.get("tiles", [[0, 0, [], []]])[0]
    if c["kind"] == "piece": c = c | {"nodes": [[t[0] for t in x] for x in first[2]], "extras": [[first[0], first[1]]]}
    z, e = [[num(t) for t in x] for x in c["nodes"]], [num(t) for t in c["extras"]]
    kind, stuck, border, claims = c["kind"], not events, c.get("border"), c["claims"]
    need(len(events) == len(modes) == len(z) - bool(stuck and e) and claims["existence"] is True, "its parts do not fit together")
    c = c | {"n": 4 if c["machine"] == "coupled" else 2, "sign": sign, "signs": [*modes, *(sign * m for m in modes[:1] or [0])],
             "letters": [*events, MIRROR.get(events[:1], events[:1]) if half else events[:1]], "before": [sign * m for m in modes[-1:]] + modes[:-1]}
    p = {name: A(num(t)) for name, t in c["parameters"].items()}
    q = finish(p | ({c["parameter"]: A(e[0])} if e else {}))
    names = {*OWN[c["machine"]].split(), "mass_ratio", "gravity", "frequency"}
    need({*p, *([c["parameter"]] if e else [])} == names and len(p) + bool(e) == len(names), "parameters are missing, or too many")
    need(all(q[name]() >= 0 for name in names - {"slope"}) and q["frequency"]() > 0, "a parameter is out of range")
    need(all(q[name]() > 0 and q[name]() <= 1 for name in names if name[:4] == "rest"), "a restitution is out of range")
    need(all(q["a", s]() >= 0 for s in (1, -1)) and c["frictionless"] == all(q["a", s]() == 0 for s in (1, -1)), "the word does not fit the friction")
    if half: need(c["periods"] % 2 and c["machine"] != "cavity", "no mirror symmetry")
    for i, letter in enumerate(events):
        fits = letter in WALL if c["frictionless"] else c["before"][i] in FITS[letter][0] and modes[i] in FITS[letter][1]
        need(fits and (letter != "t" or modes[i] == -c["before"][i]), "no machine has this word")
    wide, tau = {"fold": 2, "symmetry-breaking": 2, "period-doubling": 2, "neimark-sacker": 3}.get(kind, 1), c["periods"] * 1
    need(tau > 0 and tau == int(tau) and all(len(x) == (wide * c["n"] if events else 1) for x in z), "nodes or periods")
    if wide > 1:
        mu = {"fold": (1, half), "symmetry-breaking": (-1, True), "period-doubling": (-1, False)}.get(kind, (1, half))
        need((c.get("multiplier", 1), half) == mu and len(e) == wide - 1 and border is None, f"no system of a {kind}")
        need(c["normal"][0] in range(len(z)) and c["normal"][1] in range(c["n"]), "no component to be 1")
        need(wide == 2 or 0 not in iv.sin(e[1]), "the multipliers are real")
    elif kind == "piece": return cover(c, p, len(events))
    else: need(bool(border) == bool(e) == (kind != "orbit") and "normal" not in c and c.get("multiplier", 1) == 1, f"no {kind}")
    if border:
        (name, i, side), free = border, c["frictionless"]
        which = {"flight": "velocity-graze", "wall": "wall-graze", "approach": "wall-graze", "reversal": "wall-graze"}
        need(kind == which.get(name, "stick") and side in (1, -1) and (i == 0 if stuck else i in range(len(z))), "no border")
        fits = [name == "rest"] if stuck else [
            name == "reversal" and free, name in ("flight", "hold") and not free and (modes[i] == 0) == (name == "hold"), name == "approach"
            and events[i] in WALL, name == "wall" and events[i] in "tsu", (name, events[i]) in [("turn", "t"), ("stick", "s"), ("stop", "s"), ("slip", "u")]]
        need(any(fits) and len(e) == 1 + (name in ("flight", "hold", "reversal")), "no such margin at this event")
    if z: exists(c, p, z, e)
    name, event, side, touch = (*border, e[1] if len(e) > 1 else None) if border else ("", -1, 0, None)
    if stuck:  # the push is a harmonic of the forcing about the bias
        one, two = (motion(q, "", 0, None, A(ph))[1].rate(2)() for ph in (iv.mpf(0), iv.pi / 2))
        held = [q["a", s]() - q["bias"]() * s - iv.sqrt(one * one + two * two) for s in (1, -1)]
        found = [("stick", 0, True if all(h > 0 for h in held) or border else False if any(h < 0 for h in held) else None)]
    else: found = [(n, i, positive(test, 1 / q["frequency"]())) for n, i, test in conditions(c, q, [x[:c["n"]] for x in z], name, event, side, touch)]
    real, stable, broken = claims["real"], claims["stable"], c.get("broken")
    need(real is None or (all(v for *_, v in found) if real else (*broken, False) in found), "it is not proved real, or not virtual")
    if kind != "orbit": return need(stable is None, "stability at a special point")
    if stuck: return need(stable is None or (stable and (c["n"] == 2 or p["damping"]() > 0)), "stability")
    need(stable is None or steady(c, q, z) is stable, "it is not proved stable, or not unstable")
