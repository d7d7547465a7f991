"""The directions in (U, q) along which F = 0 holds to first order; see :mod:`contvines.loci.kernels`.

With the slopes along both parameters in units of their sizes, turned by an angle into C1 and C2, one elimination solves

    [[F_u, C1], [row]] (x, s) = (-C2, 0)  and  (0, 1):

two directions in which F stays zero, s C1 + C2 or s C1 being the change of the parameters. `row` is the second of these directions at
the point before, and C1 is across the parameters' part of the first: where that is so the matrix is regular wherever (F_u, F_p, F_q)
has full rank, at folds and where branches cross, too. At branch points it has not: there b takes the place of C1, and one more
direction goes along the null vector.

native/loci.hpp has the same for compiled problems.
"""

import math

from .layout import ALONG, ANGLE, BRANCH, KNOWN, NULL, SPARE, B, C


def rotate(columns, angle):
    """Turn C1 and C2 further."""
    c, s = math.cos(angle), math.sin(angle)
    columns[0], columns[1] = c * columns[0] + s * columns[1], c * columns[1] - s * columns[0]


def turn(work):
    """Angle and row from the two directions found last; returns by how much the angle changes."""
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
    """Direction k: unknowns of a solution, and what its part along C1 means for the parameters."""
    direction, scales, angle = work.directions[k], work.scales, work.state[ANGLE]
    n = len(solution) - 1
    direction[:n] = solution[:n]
    direction[n] = solution[n] * math.cos(angle) * scales[n]
    direction[-1] = solution[n] * math.sin(angle) * scales[len(direction) - 1]


def unfolded(work, k, solution, p=0.0, q=0.0):
    """Direction k at branch points: unknowns and unfolding of a solution, and changes of the parameters."""
    direction, n = work.directions[k], len(solution) - 1
    direction[:n] = solution[:n]
    direction[n:] = p, solution[n], q


def solve(data, work, side, column, row, step, tangent):
    """[[F_u, column], [row]] x = (-side, 0) into `step`, (0, 1) into `tangent`; returns the determinant's sign."""
    n = len(work.base_F)
    work.base_F[:], work.base_Q[:] = side[:n], column[:n]
    return data.calls.bordered(data.first, work.base, row, 0.0, step, tangent)


def plain_row(work):
    """(c, 0)."""
    row = work.lines[0]
    row[:-1], row[-1] = work.borders[C, :-1], 0.0
    return row


def span(data, work):
    """The directions but the particular one; F_p and F_q, in the units of U and q, are in `columns` and are used up."""
    columns, directions, state, scales, frame = (
        work.columns,
        work.directions,
        work.state,
        work.scales,
        work.frame,
    )
    along, null = work.solutions[ALONG], work.solutions[NULL]
    n, last = columns.shape[1], directions.shape[1] - 1
    if data.kind == BRANCH:
        row = plain_row(work)
        for k in range(2):
            solve(data, work, columns[k], work.borders[B], row, along, null)
            unfolded(work, 1 + k, along, 1.0 - k, k)
        unfolded(work, 3, null)
    else:
        columns[0] *= scales[n]
        columns[1] *= scales[last]
        if state[KNOWN] >= 0.0:
            turn(work)
            rotate(columns, state[ANGLE])
        else:  # any row, then the one that belongs to this place
            frame[:n] /= scales[:n]
            rotate(columns, state[ANGLE])
            solve(data, work, columns[1], columns[0], frame, along, null)
            rotate(columns, turn(work))
        solve(data, work, columns[1], columns[0], frame, along, null)
        parted(work, 1, null)
        parted(work, 2, along)
        directions[2, n] -= math.sin(state[ANGLE]) * scales[n]
        directions[2, last] += math.cos(state[ANGLE]) * scales[last]
    state[KNOWN] = 0.0


def particular(data, work):
    """Direction 0: what makes up for the residuals of F; returns the sign of the elimination."""
    found, spare = work.solutions[SPARE], work.solutions[SPARE + 1]
    if data.kind == BRANCH:
        sign = solve(data, work, work.residual, work.borders[B], plain_row(work), found, spare)
        unfolded(work, 0, found)
    else:
        sign = solve(data, work, work.residual, work.columns[0], work.frame, found, spare)
        parted(work, 0, found)
    return sign
