"""A recurrent cycle of events made into an orbit: Newton on the simulated return map, root, canonical order, symmetry."""

from __future__ import annotations

import numpy as np

from orbits.machines.stepping import Machine
from orbits.simulation.return_map import cyclic_distance, go_round, monodromy
from orbits.simulation.trajectory import TWO_PI

ALIKE = 1e-7
PATIENT = 2  # steps that do not make the gap smaller
SHRINKS = 0.5  # of steps from then on
NO_SPEED = 1e-7  # of the machine's own: a touch, not an impact
AT_ONCE = 1e-6  # phase from a touch to the stick that follows it
_MIRROR = np.array([1, 0, 2, 3, 4, 5], dtype=np.int8)


def polish(
    engine: Machine, params: np.ndarray, codes: np.ndarray, modes: np.ndarray, nodes: np.ndarray, periods: int
) -> tuple[np.ndarray, float, np.ndarray]:
    """Newton's method on the simulated return map, from the first node.

    Returns
    -------
    nodes : ndarray, shape (n, NODE)
    residual : float
        Largest difference between the first node and its return.
    multipliers : ndarray of complex, shape (NODE,)
        nan where displaced starts go through other events.
    """
    node = nodes[0].copy()
    best, error, matrix = nodes, np.inf, None
    step, failures = np.full(len(node), np.inf), 0
    for _ in range(40):  # a handful as a rule; near a pitchfork or fold each one gains only a factor
        there = go_round(engine, params, codes, modes, node)
        if there.message:
            break
        gap = there.nodes[-1] - node
        gap[0] -= TWO_PI * periods
        size = float(np.abs(gap).max())
        if size < error:
            error = size
            best = np.concatenate([node[None, :], there.nodes[:-1]])
        elif failures == PATIENT:
            break
        else:
            failures += 1
        if size < 3e-15:
            break
        if matrix is None or size > 1e-11:
            matrix = monodromy(engine, params, codes, modes, node)
        if matrix is None:
            break
        left = np.eye(len(node)) - matrix
        before, step = float(np.abs(step).max()), np.linalg.lstsq(left, gap, rcond=1e-7)[0]
        if not np.all(np.isfinite(step)) or np.abs(step).max() > 0.1:
            break
        # beside a bifurcation the gap may grow at first: what a step along the slow direction leaves is quick to close, but wider
        if failures and np.abs(step).max() > SHRINKS * before:
            break
        node = node + step
    matrix = monodromy(engine, params, codes, modes, best[0])
    multipliers = (
        np.full(len(node), np.nan + 0j) if matrix is None else np.linalg.eigvals(matrix).astype(complex)
    )
    return best, error, multipliers


def touches(codes: np.ndarray, nodes: np.ndarray, speeds: np.ndarray) -> np.ndarray:
    """Which events of a cycle without other impacts are touches of a wall, after which the absorber stays where it is.

    Stick-slip near a wall is pushed away from it until it only just reaches it. What is left of the impacts then is rounding; the
    motion is that without impacts, somewhere in the cavity.

    Parameters
    ----------
    codes : ndarray of int8, shape (n,)
    nodes : ndarray, shape (n, NODE)
    speeds : ndarray, shape (n,)
        Of the approach, in the machine's unit; nothing is read away from impacts.

    Returns
    -------
    ndarray of bool, shape (n,)
    """
    hits = codes < 2
    wait = (np.roll(nodes[:, 0], -1) - nodes[:, 0]) % TWO_PI
    soft = hits & (speeds < NO_SPEED) & (np.roll(codes, -1) == 3) & (wait < AT_ONCE)
    return soft if np.array_equal(soft, hits) else np.zeros_like(soft)


def root_length(codes: np.ndarray, modes: np.ndarray, nodes: np.ndarray, periods: int) -> int:
    """Events of the shortest cycle of which this one is a repetition."""
    n = len(codes)
    for times in range(periods, 1, -1):
        if n % times or periods % times:
            continue
        part = n // times
        same = np.array_equal(codes, np.roll(codes, part)) and np.array_equal(modes, np.roll(modes, part))
        if same and cyclic_distance(nodes, np.roll(nodes, part, axis=0)) < ALIKE:
            return part
    return n


def rotate(
    codes: np.ndarray, modes: np.ndarray, nodes: np.ndarray, first: int, periods: int
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """The cycle read from event `first`, its first phase in [0, 2 pi)."""
    nodes = np.roll(nodes, -first, axis=0)
    if first:
        nodes[-first:, 0] += TWO_PI * periods
    nodes[:, 0] -= TWO_PI * np.floor(nodes[0, 0] / TWO_PI)
    return np.roll(codes, -first), np.roll(modes, -first), nodes


def first_event(codes: np.ndarray, modes: np.ndarray, nodes: np.ndarray) -> int:
    """Where the cycle starts: smallest rotation of the word that starts with no slip, then smallest phase."""
    n = len(codes)

    def rank(k: int) -> tuple:
        return (tuple(np.roll(codes, -k)), tuple(np.roll(modes, -k)), nodes[k, 0] % TWO_PI)

    starts = [k for k in range(n) if codes[k] != 4] or list(range(n))
    return min(starts, key=rank)


def is_symmetric(
    codes: np.ndarray, modes: np.ndarray, nodes: np.ndarray, image: np.ndarray, tolerance: float = 1e-7
) -> bool:
    """Whether the orbit equals its mirror image (`image`, at the same phases) after half its events."""
    n = len(codes)
    if n == 0 or n % 2:
        return False
    half = n // 2
    if not (
        np.array_equal(_MIRROR[codes], np.roll(codes, half)) and np.array_equal(-modes, np.roll(modes, half))
    ):
        return False
    image = image + [np.pi, *[0.0] * (nodes.shape[1] - 1)]
    return cyclic_distance(image, np.roll(nodes, half, axis=0)) < tolerance
