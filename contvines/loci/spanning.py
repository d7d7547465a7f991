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

from .layout import (
    ALONG,
    ANGLE,
    BASE,
    BASE_F,
    BASE_Q,
    BORDERS,
    BRANCH,
    CALLS,
    COLUMNS,
    DIRECTIONS,
    FIRST,
    FRAME,
    KIND,
    KNOWN,
    LINES,
    NULL,
    POINT,
    RESIDUAL,
    SCALES,
    SOLUTIONS,
    SPARE,
    STATE,
    B,
    C,
)


def rotate(columns, angle):
    """Turn C1 and C2 further."""
    c, s = math.cos(angle), math.sin(angle)
    columns[0], columns[1] = c * columns[0] + s * columns[1], c * columns[1] - s * columns[0]


def turn(work):
    """Angle and row from the two directions found last; returns by how much the angle changes."""
    frame, scales, state, solutions = work[FRAME], work[SCALES], work[STATE], work[SOLUTIONS]
    n = frame.shape[0] - 1
    angle = -math.atan(solutions[ALONG, n])
    scaled = solutions[NULL, :n] / scales[:n]
    size = solutions[NULL, n] ** 2 + float(scaled @ scaled)
    if not (0.0 < size < math.inf and -2.0 < angle < 2.0):
        return 0.0
    frame[:n] = scaled / scales[:n] / size
    frame[n] = math.cos(angle) * solutions[NULL, n] / size
    state[ANGLE] += angle
    return angle


def parted(work, k, solution):
    """Direction k: unknowns of a solution, and what its part along C1 means for the parameters."""
    direction, scales, angle = work[DIRECTIONS][k], work[SCALES], work[STATE][ANGLE]
    n, last = solution.shape[0] - 1, direction.shape[0] - 1
    direction[:n] = solution[:n]
    direction[n] = solution[n] * math.cos(angle) * scales[n]
    direction[last] = solution[n] * math.sin(angle) * scales[last]


def plain_row(work):
    """(c, 0), into the first of LINES."""
    row, n = work[LINES][0], work[LINES].shape[1] - 1
    row[:n], row[n] = work[BORDERS][C, :n], 0.0


def solve(data, work, side, column, row, step, tangent):
    """[[F_u, column], [row]] x = (-side, 0) into `step`, (0, 1) into `tangent`; returns the determinant's sign."""
    F, Q = work[BASE_F], work[BASE_Q]
    F[:], Q[:] = side[: F.shape[0]], column[: F.shape[0]]
    return data[CALLS].bordered(data[FIRST], work[BASE], row, 0.0, step, tangent)


def span(data, work):
    """The directions but the particular one; F_p and F_q, in the units of U and q, are in COLUMNS and are used up."""
    columns, solutions, directions, state = work[COLUMNS], work[SOLUTIONS], work[DIRECTIONS], work[STATE]
    scales, borders, frame = work[SCALES], work[BORDERS], work[FRAME]
    n, last = columns.shape[1], directions.shape[1] - 1
    if data[KIND] == BRANCH:
        plain_row(work)
        for k in range(2):
            solve(data, work, columns[k], borders[B], work[LINES][0], solutions[ALONG], solutions[NULL])
            directions[1 + k, :n] = solutions[ALONG, :n]
            directions[1 + k, n] = 1.0 - k
            directions[1 + k, n + 1] = solutions[ALONG, n]
            directions[1 + k, last] = 1.0 * k
        directions[3, :n] = solutions[NULL, :n]
        directions[3, n] = 0.0
        directions[3, n + 1] = solutions[NULL, n]
        directions[3, last] = 0.0
    else:
        columns[0] *= scales[n]
        columns[1] *= scales[last]
        if state[KNOWN] >= 0.0:
            turn(work)
            rotate(columns, state[ANGLE])
        else:  # any row, then the one that belongs to this place
            frame[:n] /= scales[:n]
            rotate(columns, state[ANGLE])
            solve(data, work, columns[1], columns[0], frame, solutions[ALONG], solutions[NULL])
            rotate(columns, turn(work))
        solve(data, work, columns[1], columns[0], frame, solutions[ALONG], solutions[NULL])
        parted(work, 1, solutions[NULL])
        parted(work, 2, solutions[ALONG])
        directions[2, n] -= math.sin(state[ANGLE]) * scales[n]
        directions[2, last] += math.cos(state[ANGLE]) * scales[last]
    state[KNOWN] = 0.0


def particular(data, work):
    """Direction 0: what makes up for the residuals of F; returns the sign of the elimination."""
    solutions, directions, residuals = work[SOLUTIONS], work[DIRECTIONS], work[RESIDUAL]
    n, last = work[BASE_F].shape[0], work[POINT].shape[0] - 1
    found, spare = solutions[SPARE], solutions[SPARE + 1]
    if data[KIND] == BRANCH:
        plain_row(work)
        sign = solve(data, work, residuals, work[BORDERS][B], work[LINES][0], found, spare)
        directions[0, :n] = found[:n]
        directions[0, n] = 0.0
        directions[0, n + 1] = found[n]
        directions[0, last] = 0.0
    else:
        sign = solve(data, work, residuals, work[COLUMNS][0], work[FRAME], found, spare)
        parted(work, 0, found)
    return sign
