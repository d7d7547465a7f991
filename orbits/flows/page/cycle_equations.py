"""The equations of a declared machine's cycles, flight by flight, and their kernels.

Node i = (c_i, x_i): the clock and the states just after event i; of a self-excited machine c_i is the duration of the flight that
follows. Flight i leads from x_i to y_i. With g the function that is zero at event i + 1, and J the event's map of the states,

    g(y_i) = 0,    J(y_i) - x_{i+1} = 0

are n + 1 equations for n + 1 unknowns. The clock of the forcing is the phase psi: dx/dpsi = F = f/Omega. Therefore y_i depends on c_i
and c_{i+1} only as ends of the flight: dy/dc_{i+1} = F(y), dy/dc_i = -(dy/dx) F(x).
"""

from __future__ import annotations

import math

import numpy as np

from contvines.core.block_cyclic import eliminate
from contvines.core.library import native
from contvines.core.multipliers.periodic_schur import periodic_multipliers
from orbits.flows.equations import Approach
from orbits.flows.page.margins import fill_margins
from orbits.flows.page.pieces import Pieces, Work, strobed
from orbits.flows.plain_kernels import PlainKernels
from orbits.flows.trajectory import TWO_PI
from orbits.integrators.engine import engine
from orbits.settings import SOLVING

CYCLIC = 120  # number of unknowns above which block elimination is faster
AHEAD = 2.0  # longest flight of a forced machine, in periods of the closure; if longer, Newton's method has diverged


def _fly(data: Pieces, nodes: np.ndarray, begin: np.ndarray, end: np.ndarray, work: Work) -> bool:
    """Integrate every flight into `work.flown`; return False if one diverges."""
    numbers, flown = work.numbers, work.flown
    for flight, many, places in data.flight_groups:
        singles = places
        if many is not None:
            spare = len(places) % engine().LANES
            singles = places[-1:] if spare == 1 else places[:0]
            batch = places[: len(places) - len(singles)]
            found = np.empty((len(batch), flown.shape[1]))
            if not many(nodes[batch, 1:], begin[batch], end[batch], numbers[batch], found):
                return False
            flown[batch] = found
        for i in singles:
            if not flight(nodes[i, 1:], float(begin[i]), float(end[i]), numbers[i], flown[i]):
                return False
    return True


def closing(data: Pieces, work: Work) -> tuple[np.ndarray, np.ndarray]:
    """Return the blocks of the last row, with the closure by the mirror."""
    own, following = work.own[-1], work.following[-1] * data.turned
    for row, _ in data.still:
        own = own.copy()
        own[1 + row], following[1 + row] = 0.0, work.still[row]
    for j in data.resting:
        own = own.copy()
        own[1 + j] = following[1 + j] = 0.0
        following[1 + j, 1 + j] = 1.0
    return own, following


def by_blocks(
    data: Pieces, work: Work, border: np.ndarray, target: float, step: np.ndarray, tangent: np.ndarray
) -> float:
    """Solve the bordered system by block elimination; return the sign of the determinant."""
    length, d = data.length, data.size + 1
    blocks = np.empty((length, d, 2 * d))
    blocks[:-1, :, :d], blocks[:-1, :, d:] = work.own[:-1], work.following[:-1]
    blocks[-1, :, :d], blocks[-1, :, d:] = closing(data, work)
    columns = np.empty((length, d, 3))
    columns[:, :, 0], columns[:, :, 1], columns[:, :, 2] = work.derivative, -work.residual, 0.0
    rows, foot = border[:-1].reshape(length, 1, d), np.array([[border[-1], target, 1.0]])
    back = slice(None, None, -1) if work.turned[0] else slice(None)
    if work.turned[
        0
    ]:  # blocks of a column become those of a row; in reversed order the neighbour follows again
        before = np.roll(blocks[:, :, d:], 1, axis=0)
        blocks = np.concatenate([blocks[:, :, :d], before], axis=1).transpose(0, 2, 1)[back]
        columns, rows = columns[back], rows[back]
    if not (np.isfinite(blocks).all() and np.isfinite(columns).all() and np.isfinite(rows).all()):
        return 0.0
    found = eliminate(blocks, columns, rows, foot, d)
    for k, place in enumerate((step, tangent)):
        place[:-1], place[-1] = found.states[back, :, k].ravel(), found.shared[0, k]
    return -found.sign if d % 2 and length % 2 == 0 else found.sign  # the first node is eliminated last


def factors(data: Pieces, work: Work) -> np.ndarray:
    """Return the derivatives of node i + 1 by node i, shape (L, m, m): with the clock for a forced machine, otherwise of the states alone."""
    own, following = work.own, work.following
    with np.errstate(all="ignore"):
        if data.forced:
            clock = -own[:, :1, :] / following[:, 0, 0][:, None, None]
            states = own[:, 1:, :] + following[:, 1:, :1] * clock
            result = np.concatenate([clock, states], axis=1)
        else:
            through = own[:, :, 1:]
            duration = -through[:, :1, :] / own[:, 0, 0][:, None, None]
            result = through[:, 1:, :] + own[:, 1:, :1] * duration
    if data.twist < 0.0:  # the mirror after the last flight: the states change sign, the clock does not
        result = result.copy()
        result[-1, (1 if data.forced else 0) :, :] *= -1.0
    return result


def multipliers(data: Pieces, work: Work) -> np.ndarray:
    """Return the multipliers of the closed map between event surfaces, largest first, without the one that is always zero."""
    chain = factors(data, work)
    if not np.all(np.isfinite(chain)):
        return np.full(data.n_multipliers, np.nan, complex)
    size = chain.shape[1]
    norms = np.abs(chain).sum(axis=2).max(axis=1)
    if np.log(np.maximum(norms, 1.0)).sum() < np.log(SOLVING.safe_product) or len(chain) == 1:
        product = chain[0]
        for factor in chain[1:]:
            product = factor @ product
        values = np.linalg.eigvals(product).astype(complex)
    else:
        values = _periodic(chain, size)
    values = values[np.argsort(-np.abs(values), kind="stable")]
    for _ in range(
        data.trivial
    ):  # trivial multipliers of motions that can be shifted as a whole, and of frictions that stick for ever
        values = np.delete(values, int(np.argmin(np.abs(values - data.twist))))
    return values[: data.n_multipliers]


def _periodic(chain: np.ndarray, size: int) -> np.ndarray:
    re, im = np.zeros(size), np.zeros(size)
    periodic_multipliers(chain, np.tile(-np.eye(size), (len(chain), 1, 1)), 1.0, re, im)
    return re + 1j * im


class PageKernels(PlainKernels[Pieces, Work]):
    """Kernels for the cycles of declared machines, in plain Python, with integrated flights."""

    column = 3
    accepted = SOLVING.residual
    patience = 0.5

    def linearise(self, data: Pieces, u: np.ndarray, p: float, work: Work) -> float:
        """Write F, its blocks and its parameter derivative into `work`; return the largest absolute residual (inf if not evaluable)."""
        n, length = data.size, data.length
        nodes = np.asarray(u).reshape(length, n + 1)
        if not (np.all(np.isfinite(nodes)) and math.isfinite(p)) or not data.allowed(p):
            return math.inf
        work.turned[0] = 0.0
        numbers = work.numbers
        numbers[:] = data.base_numbers
        numbers[:, data.index] = p
        begin, end = data.clocks(nodes)
        spans = end - begin
        if np.abs(spans).max() > (AHEAD * data.shift if data.forced else SOLVING.longest_flight):
            return math.inf
        if not _fly(data, nodes, begin, end, work):
            return math.inf
        flown = work.flown
        arrival = work.arrival
        arrival[:] = flown[:, :n]
        sensitivity = flown[:, n:].reshape(length, n, -1)
        by_state, by_number = sensitivity[:, :, :n], sensitivity[:, :, n]
        for values, places in data.rate_groups:
            rates = values(
                np.concatenate([nodes[places, 1:], arrival[places]]),
                np.concatenate([begin[places], end[places]]),
                np.concatenate([numbers[places], numbers[places]]),
            )
            work.first_rates[places], work.last_rates[places] = rates[: len(places)], rates[len(places) :]
        work.end[:] = end
        onward = np.empty((length, n))  # x_{i+1}
        onward[:-1] = nodes[1:, 1:]
        onward[-1] = data.twist * nodes[0, 1:]
        residual, own, following, derivative = work.residual, work.own, work.following, work.derivative
        slopes, explicit, along = (
            np.zeros((length, n + 1, n)),
            np.zeros((length, n + 1)),
            np.zeros((length, n + 1)),
        )
        slopes[:, 1:] = data.identity
        value = np.empty((length, n + 1))
        value[:, 1:] = arrival
        for values, places, jumps in data.event_groups:
            if values is None:  # the strobes of a motion without events: at phase zero
                value[:, 0], explicit[:, 0] = end - data.shift * np.arange(1, length + 1) / length, 1.0
                continue
            # columns of `table`: value, by states, by clock, by the parameter; rows: g, then J
            table = values(arrival[places], end[places], numbers[places]).reshape(len(places), -1, n + 3)
            rows = slice(None) if jumps else slice(0, 1)
            value[places, rows], slopes[places, rows] = table[:, :, 0], table[:, :, 1 : n + 1]
            explicit[places, rows], along[places, rows] = table[:, :, n + 1], table[:, :, n + 2]
        residual[:] = value
        residual[:, 1:] -= onward
        through = slopes @ by_state
        by_end = (slopes @ work.last_rates[:, :, None])[:, :, 0]
        own[:, :, 1:] = through
        following[:] = data.minus
        if data.forced:
            own[:, :, 0] = -(through @ work.first_rates[:, :, None])[:, :, 0]
            following[:, :, 0] = by_end + explicit
        else:
            own[:, :, 0] = by_end
        derivative[:] = (slopes @ by_number[:, :, None])[:, :, 0] + along
        for j in data.pinned:  # the motion can be shifted along this state: require mean zero over the nodes
            work.drift[j] = residual[-1, 1 + j]
            residual[-1, 1 + j] = nodes[:, 1 + j].mean()
            derivative[-1, 1 + j] = 0.0
        for j in data.resting:
            residual[-1, 1 + j] = derivative[-1, 1 + j] = 0.0
        for row, values in data.still:  # for a friction that sticks for ever: require zero velocity
            table = values(nodes[:1, 1:], begin[:1], numbers[:1])[0]
            residual[-1, 1 + row], derivative[-1, 1 + row] = table[0], table[n + 2]
            work.still[row, 0], work.still[row, 1:] = table[n + 1], table[1 : n + 1]
        size = float(np.abs(residual).max())
        return size if math.isfinite(size) else math.inf

    def fill(self, data: Pieces, work: Work, matrix: np.ndarray) -> None:
        """Write the blocks of F_u into a dense matrix of zeros."""
        d, length = data.size + 1, data.length
        last_own, last_following = closing(data, work)
        for i in range(length - 1):
            rows = slice(i * d, (i + 1) * d)
            matrix[rows, i * d : (i + 1) * d] += work.own[i]
            matrix[rows, (i + 1) * d : (i + 2) * d] += work.following[i]
        rows = slice((length - 1) * d, length * d)
        matrix[rows, rows] += last_own
        matrix[rows, :d] += last_following
        for j in data.pinned:
            row = (length - 1) * d + 1 + j
            matrix[row, : length * d] = 0.0
            matrix[row, 1 + j : length * d : d] = 1.0 / length
        if work.turned[0]:
            matrix[: length * d, : length * d] = matrix[: length * d, : length * d].T.copy()

    def bordered(
        self,
        data: Pieces,
        work: Work,
        border: np.ndarray,
        target: float,
        step: np.ndarray,
        tangent: np.ndarray,
    ) -> float:
        """Solve the bordered system (see `PlainKernels.bordered`); long cycles by block elimination."""
        if data.dimension > CYCLIC and not data.pinned and native():
            return by_blocks(data, work, border, target, step, tangent)
        return super().bordered(data, work, border, target, step, tangent)

    def assign(self, data: Pieces, other: Pieces, value: float) -> None:
        """Set, in ``data`` and in place, the parameter that varies in ``other``."""
        data.params[other.index] = value
        data.base_numbers[:, other.index] = value

    def flip(self, data: Pieces, work: Work, sign: float) -> None:
        """Turn F_u into the matrix for perturbations that change sign over the period (sign = -1), and back (sign = 1)."""
        work.following[-1] *= -1.0

    def transpose(self, data: Pieces, work: Work, column: np.ndarray, other: Work) -> None:
        """Write the transposed F_u, with another last column, into another workspace."""
        for name in ("own", "following", "drift", "still", "numbers"):
            getattr(other, name)[:] = getattr(work, name)
        other.derivative.reshape(-1)[:] = column
        other.turned[0] = 1.0

    def matrix(self, data: Pieces, work: Work) -> np.ndarray:
        """Return F_u as a workspace holds it, shape (N, N)."""
        found = np.zeros((data.dimension, data.dimension))
        self.fill(data, work, found)
        return found

    def inspect(self, data: Pieces, u: np.ndarray, p: float, work: Work, row: np.ndarray) -> None:
        """Write multipliers as pairs (re, im), then the margins, into `row`."""
        m = data.n_multipliers
        row[: 2 * m].view(np.complex128)[:] = multipliers(data, work)
        fill_margins(data, u, work, row[2 * m :])


KERNELS = PageKernels()


class PageEquations(Pieces):
    """The equations of one word's cycles; constructed like `Pieces`."""

    # ------------------------------------------------------------------ numerics
    @property
    def data(self) -> PageEquations:  # type: ignore[override]
        """The equations themselves."""
        return self

    @property
    def kernels(self) -> PageKernels:
        """The kernels, in plain Python."""
        return KERNELS

    def approach(self, u: np.ndarray, p: float, place: int, near: float) -> Approach:
        """Return the rate of the wall's gap after the impact at a place, and its derivatives; `push` is the wall's impulse direction."""
        compiled, d = self.model.compiled, self.size + 1
        node = u[place * d : (place + 1) * d]
        numbers = compiled.numbers(self.values(p), self.word.entries(place))
        clock = float(node[0]) if self.forced else 0.0
        row = compiled.approach(self.letters[place].contact).one(node[1:], clock, numbers)
        return Approach(float(row[0]), np.append(0.0, row[1:d]), 0.0, np.append(0.0, row[d:]))

    def through_flights(self, u: np.ndarray, p: float) -> tuple[np.ndarray, None] | None:
        """Return the derivatives of each node by the one before, the mirror included in the last; None if not evaluable."""
        if not np.isfinite(self.kernels.linearise(self, u, p, self.scratch)):
            return None
        with np.errstate(all="ignore"):
            return factors(self, self.scratch), None

    def reduce(self, nodes: np.ndarray) -> np.ndarray:
        """Return the unknowns, shape (N,), from the nodes of the whole cycle; without events, nodes are computed from the first if their number differs."""
        often = self.length * (2 if self.symmetric else 1) // self.periods
        spacing = (
            float(np.ptp(nodes[:2, 0])) * often / TWO_PI
        )  # distance of the given nodes relative to that of the unknown nodes
        if not len(self.word) and self.length > 1 and abs(spacing - 1.0) > 0.1:
            nodes = strobed(self.model, self.word, self.periods, nodes[0], self.params, often)
        return super().reduce(nodes)
