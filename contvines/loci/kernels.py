"""Kernels of a locus: special points of F(u, p, q) = 0 as solutions of an extended system, continued in the second parameter q.

The unknowns are U = (u, p), at branch points (u, p, e), with p in units of data.unit; q is the continuation parameter. The equations are

    F(u, p, q) + e b = 0,    g(u, p, q) = 0    (at branch points two of them),

minimally augmented (Griewank and Reddien, Math. Comp. 43 (1984) 511; Govaerts, Numerical Methods for Bifurcations of
Dynamical Equilibria, 2000, chapters 3 and 4). With borders b and c, M = [[F_u, b], [c, 0]] and M (v, g) = (0, 1):

    fold             g, which is zero if F_u is singular
    flip             g of the flipped F_u, for perturbations that change sign over the period
    branch point     g, and the last entry of M^-1 (F_p, 0): F_u and (F_u, F_p) lose rank together; e stays zero
    margin           one margin, of a border
    period           the period, an unknown, minus a given value: for cycles that represent homoclinic orbits
    growth           the logarithm of the only multiplier, for folds of cycles in the plane
    pair             m1 m2 - 1 for a pair of multipliers, l1 + l2 for eigenvalues of a flow
    own              the condition of a user-defined kind

One Newton step works as follows. Each linear system is one elimination by the problem's kernel, with another column in place of F_p.

1. A particular direction corrects the residuals of F to first order. The tests g are evaluated at the corrected point, so that their error is of
   second order in the step.
2. Two further directions (at branch points three) keep F = 0 to first order. The tests are differentiated along these directions only, by differences.
3. A small system with these derivatives and the border gives the step and the tangent.

Directions and derivatives are reused if Newton's method has hardly moved; the residuals remain exact, so this does not affect the accuracy. The borders
are renewed after a few accepted points, or earlier if the null vector turns: c becomes the right null vector, b the left one.

The two directions: let C1 and C2 be the derivatives of F by the two parameters, in units of their sizes, rotated by an angle. One elimination solves

    [[F_u, C1], [row]] (x, s) = (-C2, 0)  and  (0, 1),

which gives two directions with F = 0, in which the parameters change by s C1 + C2 and by s C1. `row` is the second of these directions at the previous
point, and C1 is orthogonal to the parameter part of the first one. Then the matrix is regular wherever (F_u, F_p, F_q) has full rank, also at folds and
where branches cross. At branch points the rank is not full: b replaces C1, and there is one more direction, along the null vector.

native/loci.hpp does the same for compiled problems.
"""

import math

import numpy as np

from ..bifurcation.settings import LOCATING
from ..problems.protocol import Problem
from ..shared.numbers import PIVOT, ROUNDED
from .settings import SCALING

# conditions of loci; PERIOD, GROWTH and OWN exist in Python only
FOLD, FLIP, MARGIN, PAIR, BRANCH, PERIOD, GROWTH, OWN = range(8)
LARGEST_DISTANCE = 0.03  # largest distance from an equilibrium, relative to its size, of a cycle that represents a homoclinic orbit

#: kind of a special point -> condition of its locus; borders have the condition MARGIN
CONDITIONS = {
    "fold": FOLD,
    "branch-point": BRANCH,
    "neimark-sacker": PAIR,
    "hopf": PAIR,
    "period-doubling": FLIP,
    "symmetry-breaking": FLIP,
    "homoclinic": PERIOD,
}

ALONG, NULL, TESTED, LEFT, SPARE = range(5)  # rows of `solutions`; SPARE has two
B, C, FLIP_B, FLIP_C = range(4)  # rows of `borders`
# entries of `state`; VALID: -1 nothing is valid, 0 the directions are, 1 the tests' derivatives, too
VALID, SIGN, ANGLE, AGE = range(4)
LONGEST = 4  # points after which borders are renewed
TURNED = 1.02  # length of the null vector at which borders are renewed; it is 1 when they are new


def condition(problem: Problem, kind: str) -> int:
    """Return the condition of the locus of special points of a kind, in a given problem.

    A symmetry breaking or period doubling is a multiplier -1 if the problem's ``flip_kind`` is this kind; else it is a branch point
    of the problem on solutions with a symmetry.
    """
    found = CONDITIONS.get(kind, MARGIN)
    if found == FLIP and not (problem.spectrum == "map" and problem.flip_kind == kind):
        return BRANCH
    return found


# ------------------------------------------------------------------ tests
def null_test(data, work, b, c):
    """Solve M (v, g) = (0, 1) with the linearisation in `trial`; return g."""
    line, step, null = *work.lines, work.solutions[TESTED]
    work.trial_F[:], work.trial_Q[:], line[:-1], line[-1] = 0.0, b[:-1], c[:-1], 0.0
    data.calls.bordered(data.first, work.trial, line, 0.0, step, null)
    return null[-1]


def pair_of(row, multipliers, flow, reference):
    """Return (test, position) of the pair nearest to the stability boundary and to the reference; NaN if there is none.

    For maps these are m1 m2 - 1 and (m1 + m2)/2, the cosine of the angle; for flows l1 + l2 and l1 l2, the square of the frequency.
    """
    found, best = (math.nan, math.nan), math.inf
    for i in range(multipliers):
        a, b = row[2 * i], row[2 * i + 1]
        for j in range(i + 1, multipliers):
            c, d = row[2 * j], row[2 * j + 1]
            if abs(b + d) > LOCATING.rounding * (1.0 + abs(b)) or (
                b != 0.0 and abs(a - c) > LOCATING.rounding * (1.0 + abs(a))
            ):
                continue  # neither two real multipliers nor a conjugate pair
            total, product = a + c, a * c - b * d
            test, place = (total, product) if flow else (product - 1.0, 0.5 * total)
            unit = 1.0 + abs(reference) if flow else 1.0
            distance = abs(test) + 0.1 * abs(place - reference) / unit
            if distance < best:
                found, best = (test, place), distance
    return found


def tests(data, work, u, p, q, values):
    """Evaluate the tests g at any (u, p, q) into `values`; the linearisation in `trial` is overwritten."""
    first, trial, borders, calls, kind = data.first, work.trial, work.borders, data.calls, data.kind
    calls.assign(first, data.second, q)
    if not math.isfinite(calls.linearise(first, u, p, trial)):
        return
    if kind == FOLD:
        values[0] = null_test(data, work, borders[B], borders[C])
    elif kind == FLIP:  # the second flip restores the linearisation
        calls.flip(first, trial, -1.0)
        values[0] = null_test(data, work, borders[FLIP_B], borders[FLIP_C])
        calls.flip(first, trial, 1.0)
    elif kind == BRANCH:
        line, step, null = *work.lines, work.solutions[TESTED]
        work.trial_F[:] = data.unit * work.trial_Q
        work.trial_Q[:], line[:-1], line[-1] = borders[B, :-1], borders[C, :-1], 0.0
        calls.bordered(first, trial, line, 0.0, step, null)
        values[:2] = null[-1], step[-1]
    elif kind == PERIOD:
        values[0] = u[data.which] / work.reference[0] - 1.0
    elif kind == OWN:
        values[0] = data.own(u, p, q, trial, work.row)
    else:
        row = work.row
        calls.inspect(first, u, p, trial, row)
        if kind == MARGIN:
            values[0] = row[2 * data.multipliers + data.which]
        elif kind == GROWTH:
            values[0] = math.log(abs(row[0])) if row[0] != 0.0 else -math.inf
        else:
            values[0] = pair_of(row, data.multipliers, data.flow, work.reference[0])[0]


def slopes_along(data, work, direction):
    """Return the derivatives of the tests along a direction in (U, q), by differences."""
    point, n = work.point, len(work.base_F)
    slopes = np.zeros(len(point) - 1 - n)
    parts = np.abs(direction) / np.maximum(work.scales[: len(point)], np.abs(point))
    length = max(parts[-1], parts[: n + 1].max())
    if not length > ROUNDED:
        return slopes
    h = SCALING.step / length
    shifted = point + h * direction
    tests(data, work, shifted[:n], data.unit * shifted[n], shifted[-1], slopes)
    return (slopes - work.values[: len(slopes)]) / h


# ------------------------------------------------------------------ directions with F = 0
def rotate(columns, angle):
    """Rotate C1 and C2 by a further angle, in place."""
    c, s = math.cos(angle), math.sin(angle)
    columns[0], columns[1] = c * columns[0] + s * columns[1], c * columns[1] - s * columns[0]


def turn(work):
    """Update angle and row from the last two directions; return the change of the angle."""
    along, null = work.solutions[ALONG], work.solutions[NULL]
    n = len(null) - 1
    angle = -math.atan(along[n])
    scaled = null[:n] / work.scales[:n]
    size = null[n] ** 2 + float(scaled @ scaled)
    if not (0.0 < size < math.inf and -2.0 < angle < 2.0):
        return 0.0
    work.frame[:n] = scaled / work.scales[:n] / size
    work.frame[n] = math.cos(angle) * null[n] / size
    work.state[ANGLE] += angle
    return angle


def parted(work, k, solution):
    """Write direction k from a solution: its unknowns, and the changes of the parameters from its last entry (along C1)."""
    direction, scales, angle = work.directions[k], work.scales, work.state[ANGLE]
    n = len(solution) - 1
    direction[:n] = solution[:n]
    direction[n] = solution[n] * math.cos(angle) * scales[n]
    direction[-1] = solution[n] * math.sin(angle) * scales[len(direction) - 1]


def unfolded(work, k, solution, p=0.0, q=0.0):
    """Write direction k at branch points: unknowns and unfolding e from a solution, and given changes of the parameters."""
    direction, n = work.directions[k], len(solution) - 1
    direction[:n] = solution[:n]
    direction[n:] = p, solution[n], q


def solve(data, work, side, column, row, step, tangent):
    """Solve [[F_u, column], [row]] x = (-side, 0) into `step` and = (0, 1) into `tangent`; return the determinant's sign."""
    n = len(work.base_F)
    work.base_F[:], work.base_Q[:] = side[:n], column[:n]
    return data.calls.bordered(data.first, work.base, row, 0.0, step, tangent)


def span(data, work):
    """Compute all directions except the particular one; `columns` holds F_p and F_q and is overwritten."""
    columns, directions, state, scales = work.columns, work.directions, work.state, work.scales
    along, null, frame = work.solutions[ALONG], work.solutions[NULL], work.frame
    n, last = columns.shape[1], directions.shape[1] - 1
    if data.kind == BRANCH:
        row = np.append(work.borders[C, :-1], 0.0)
        for k in range(2):
            solve(data, work, columns[k], work.borders[B], row, along, null)
            unfolded(work, 1 + k, along, 1.0 - k, k)
        unfolded(work, 3, null)
    else:
        columns[0] *= scales[n]
        columns[1] *= scales[last]
        if state[VALID] >= 0.0:
            turn(work)
            rotate(columns, state[ANGLE])
        else:  # the first time: start with a random row, then use the one of this point
            frame[:n] /= scales[:n]
            rotate(columns, state[ANGLE])
            solve(data, work, columns[1], columns[0], frame, along, null)
            rotate(columns, turn(work))
        solve(data, work, columns[1], columns[0], frame, along, null)
        parted(work, 1, null)
        parted(work, 2, along)
        directions[2, n] -= math.sin(state[ANGLE]) * scales[n]
        directions[2, last] += math.cos(state[ANGLE]) * scales[last]
    state[VALID] = 0.0


def particular(data, work):
    """Compute direction 0, which corrects the residuals of F, and store the sign of the determinant."""
    found, spare = work.solutions[SPARE], work.solutions[SPARE + 1]
    if data.kind == BRANCH:
        row = np.append(work.borders[C, :-1], 0.0)
        work.state[SIGN] = solve(data, work, work.residual, work.borders[B], row, found, spare)
        unfolded(work, 0, found)
    else:
        work.state[SIGN] = solve(data, work, work.residual, work.columns[0], work.frame, found, spare)
        parted(work, 0, found)


# ------------------------------------------------------------------ the kernels
def frozen(work, point):
    """Whether the point has moved so little that directions and derivatives of the last call can be reused; if not, store the point.

    The derivatives have errors of about the difference step, and they do not change more over such a distance.
    """
    sizes = np.maximum(work.scales[: len(point)], np.abs(point))
    if work.state[VALID] > 0.0 and (np.abs(point - work.frozen) < SCALING.step * sizes).all():
        return True
    work.frozen[:] = point
    return False


def locus_linearise(data, U, q, work):
    """Evaluate F, its derivatives and the tests at (U, q); see `linearise` in the protocol."""
    first, second, base, state, residuals = data.first, data.second, work.base, work.state, work.residual
    n, size, calls = len(work.base_F), len(U), data.calls
    u, p = U[:n], data.unit * U[n]
    place = np.append(U, q)
    unmoved = frozen(work, place)
    if not unmoved:
        state[VALID] = min(state[VALID], 0.0)
        calls.assign(second, first, p)
        if not math.isfinite(calls.linearise(second, u, q, base)):
            return math.inf
        work.columns[1] = work.base_Q
    calls.assign(first, second, q)
    largest = calls.linearise(first, u, p, base)
    if not math.isfinite(largest):
        return math.inf
    residuals[:n] = work.base_F + U[n + 1] * work.borders[B, :n] if data.kind == BRANCH else work.base_F
    if not unmoved:
        work.columns[0] = data.unit * work.base_Q
        span(data, work)
    particular(data, work)
    point = work.point
    point[:] = place + work.directions[0]
    tests(data, work, point[:n], data.unit * point[n], point[size], work.values)
    residuals[n:] = work.values[: size - n]
    work.last_residual[:] = residuals
    return max(largest, *map(abs, residuals[n:].tolist())) if np.isfinite(residuals[n:]).all() else math.inf


def locus_bordered(data, work, border, target, step, tangent):
    """Solve the bordered system of the locus; see `bordered` in the protocol."""
    directions, residuals, state = work.directions, work.residual, work.state
    n = len(work.base_F)
    count = len(residuals) - n  # number of tests; besides the particular direction there are count + 1
    others, slopes = directions[1 : count + 2], np.zeros(count)
    # if the caller has changed the residuals, the particular direction must be computed again
    if (residuals != work.last_residual).any():
        particular(data, work)
        slopes = slopes_along(data, work, directions[0])
        work.last_residual[:] = math.nan
    if state[VALID] < 1.0:
        for steep, direction in zip(work.steep, others):
            steep[:count] = slopes_along(data, work, direction)
        state[VALID] = 1.0
    small = np.zeros((count + 1, count + 3))
    small[:, : count + 1] = np.vstack([work.steep[: count + 1, :count].T, others @ border])
    small[:count, -2] = -residuals[n:] - slopes
    small[count, -2:] = target - border @ directions[0], 1.0
    sign = state[SIGN] * close(small)
    step[:] = directions[0] + small[:, -2] @ others
    tangent[:] = small[:, -1] @ others
    return sign


def close(small):
    """Solve a small system with two right-hand sides by Gauss elimination with pivoting, in place; return the determinant's sign."""
    sign, size = 1.0, len(small)
    for j in range(size):
        best = j + int(np.abs(small[j:, j]).argmax())
        if best != j:
            small[[j, best]], sign = small[[best, j]], -sign
        if small[j, j] == 0.0:
            small[j, j] = PIVOT
        if small[j, j] < 0.0:
            sign = -sign
        for i in range(j + 1, size):
            small[i, j:] -= small[i, j] / small[j, j] * small[j, j:]
    for j in reversed(range(size)):
        small[j, size:] = (small[j, size:] - small[j, j + 1 : size] @ small[j + 1 :, size:]) / small[j, j]
    return sign


def renew(data, work, b, c, null):
    """Renew the borders: c along the right null vector `null`, b along the left one, in units of the scales; `base` holds the linearisation."""
    n = len(b) - 1
    lines, left, scales, rows = work.lines, work.solutions[LEFT], work.scales[:n], work.rows
    size = float(np.linalg.norm(null[:n] / scales))
    if not 0.0 < size < math.inf:
        return
    c[:n] = null[:n] / scales / scales / size
    lines[0, :n], lines[0, n] = b[:n], 0.0
    data.calls.transpose(data.first, work.base, c[:n], work.trial)
    work.trial_F[:] = 0.0
    data.calls.bordered(data.first, work.trial, lines[0], 0.0, lines[1], left)
    size = float(np.linalg.norm(left[:n] * rows))
    if not 0.0 < size < math.inf:
        return
    b[:n] = left[:n] * rows * rows / size


def worn(work, null):
    """Whether the borders should be renewed: the null vector has turned away from c, or they have been used for LONGEST points."""
    state, n = work.state, len(null) - 1
    state[AGE] += 1.0
    if state[AGE] < LONGEST and np.linalg.norm(null[:n] / work.scales[:n]) < TURNED:
        return False
    state[AGE] = 0.0
    return True


def locus_inspect(data, U, q, work, row):
    """Write multipliers and margins of the problem, then three margins of the locus: p above its lower and below its upper bound, and the pair still complex.

    It also renews the borders if necessary.
    """
    first, base, borders, reference = data.first, work.base, work.borders, work.reference
    kind, null, margins = data.kind, work.solutions[TESTED], row[2 * data.multipliers :]
    n = len(work.base_F)
    if kind in (FOLD, BRANCH, FLIP) and worn(work, null):
        work.state[VALID] = min(work.state[VALID], 0.0)  # derivatives with the old borders are invalid
        if kind != FLIP:
            renew(data, work, borders[B], borders[C], null)
        else:
            data.calls.flip(first, base, -1.0)
            renew(data, work, borders[FLIP_B], borders[FLIP_C], null)
            data.calls.flip(first, base, 1.0)
    data.calls.assign(first, data.second, q)  # the tests were evaluated at other values of q
    data.calls.inspect(first, U[:n], data.unit * U[n], base, row[:-3])
    margins[-3:] = U[n] - reference[3], reference[4] - U[n], math.inf
    if kind == PERIOD:  # the cycle represents a homoclinic orbit as long as it comes near an equilibrium
        margins[0] = math.log10(LARGEST_DISTANCE / first.from_rest(U[:n], data.unit * U[n]))
    margins[work.masked] = math.inf
    if kind == PAIR:
        place = reference[0] = pair_of(row, data.multipliers, data.flow, reference[0])[1]
        margins[-1] = place if data.flow else 1.0 - place * place
