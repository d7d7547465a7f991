"""AlgebraicProblem: solutions of F(u, p) = 0, or equilibria of u' = F(u, p), with F a Python callable."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from contvines.shared.near_names import hinting

from .callables import CallableProblem
from .dense import DenseWork
from .derivatives import Differentiated
from .functions import Operator, Outputs, ParameterSet, Sparse, readonly
from .pieces import Pieces
from .protocol import Symmetry
from .registry import addresses, find_callables
from .scales import flat_start, given_scale
from .settings import SIMULATION
from .spectra import NEAREST, WATCHED, rounding, vectors_of, without_roundoff
from .symmetries import image_map, images_of, refuse_no_group, smallest_image

if TYPE_CHECKING:
    from numpy.typing import ArrayLike
    from scipy.sparse import csc_array

    from .abilities import Linearised
    from .conditions import Conditions
    from .large.sparse import SparseWork

ZERO_SPECTRUM = np.zeros(NEAREST, dtype=complex)
PATIENCE = 4000  # integrator steps from one start; after these it counts as an oscillation
SPREAD = 2.0  # half-width of the box of starts, in sizes of the unknowns
LARGEST = 60  # most unknowns of equations that are integrated for attractors


class AlgebraicProblem(CallableProblem):
    """Solutions of F(u, p) = 0, or equilibria of u' = F(u, p).

    Parameters
    ----------
    F : callable
        (u of shape (N,), p) -> N numbers. u is read-only. With ``switches`` F has a third argument.
    u0 : array_like, shape (N,) or scalar
        A start; an approximate solution is enough.
    p0 : float, or mapping of str to float
        Parameter value of the start, or the values of several parameters by name: ``F(u, p)`` then reads ``p.name``.
    parameter : str
        Name of the parameter that varies; by default the first of several.
    jacobian : callable, optional
        (u, p) -> dF/du of shape (N, N): an array, a matrix of ``scipy.sparse`` in any format, or a LinearOperator, which is never
        factorised. By default the complex step if F allows it, else differences with an error estimate. A given Jacobian is
        compared with differences of F at the start and at every special point.
    derivative : callable, or mapping of str to callable, optional
        (u, p) -> dF/dp of shape (N,); a mapping by name for several parameters.
    spectrum : {"none", "flow"}
        "flow": stability and Hopf points from the eigenvalues of dF/du. With "none" stability is not computed.
    mirror : callable, matrix or permutation, optional
        u -> image of u that solves the same equations; branch points of symmetric solutions are then symmetry breakings, and only
        one of two mirror images is traced.
    name : str, optional
        For tables.
    scale : float or array_like of shape (N,), optional
        Typical size of each unknown; learned from the start and the branch if it is left out.
    symmetries : sequence of callables, matrices or permutations, optional
        Further images of u that solve the same equations: generators of a finite group. Only one of equivalent branches is traced.
    conditions : sequence of callables, optional
        (u, p) -> number that must be zero: one condition, such as a phase condition, for each continuous symmetry.
    switches : mapping of str to callable, optional
        (u, p) -> number whose sign selects a piece of F. F is then called as F(u, p, sign) with a mapping from the names to
        +1 or -1, must be smooth for fixed signs, and must not look at the switches itself.
    leading : int
        Number of eigenvalues of a sparse or matrix-free Jacobian, for spectrum "flow".
    shift : float
        The eigenvalues nearest to this number are computed.
    preconditioner : callable, optional
        (u, p) -> LinearOperator or array, an approximate inverse of dF/du, for a matrix-free Jacobian.
    sparsity : sparse matrix or array of shape (N, N), optional
        Pattern, not zero where F_i depends on u_j. Without a ``jacobian`` the sparse Jacobian is then computed by differences (or the
        complex step); columns that share no row are differentiated together.
    outputs : mapping of str to callable, optional
        (u, p) -> number: additional measures for tables, pictures and exports.

    Raises
    ------
    ValueError
        If F does not return N finite numbers at the start, or a given derivative or symmetry disagrees with it.
    """

    @hinting
    def __init__(
        self,
        F: Callable,
        u0: Sequence[float] | np.ndarray | float,
        p0: float | Mapping[str, float] = 0.0,
        parameter: str = "p",
        jacobian: Callable | None = None,
        derivative: Callable | Mapping[str, Callable] | None = None,
        spectrum: str = "none",
        mirror: Callable[[np.ndarray], ArrayLike] | ArrayLike | None = None,
        name: str = "algebraic",
        scale: ArrayLike | None = None,
        symmetries: Sequence[Callable[[np.ndarray], ArrayLike] | ArrayLike] = (),
        conditions: Sequence[Callable] = (),
        switches: Mapping[str, Callable] | None = None,
        leading: int = 10,
        shift: float = 0.0,
        preconditioner: Callable | None = None,
        outputs: Mapping[str, Callable] | None = None,
        sparsity: ArrayLike | Sparse | None = None,
    ) -> None:
        if spectrum not in ("none", "flow"):
            raise ValueError(f'spectrum = {spectrum!r} must be "none" or "flow"; for maps use MapProblem')
        if not (isinstance(leading, int) and leading >= 1):
            raise ValueError(f"leading = {leading!r} must be a whole number of at least 1")
        start = flat_start(u0)
        self.values = ParameterSet(p0, parameter)
        self.spectrum, self.name = spectrum, name
        self.node = len(start)
        self.leading, self.shift, self.preconditioner = leading, float(shift), preconditioner
        self.pieces = Pieces(switches, self.values, start[None, :])
        self.given = {
            "F": F,
            "jacobian": jacobian,
            "derivative": derivative,
            "mirror": mirror,
            "preconditioner": preconditioner,
        }
        colours = None
        if sparsity is not None:
            from .large.jacobians import Colouring

            colours = Colouring(sparsity, self.node)
        self.functions = Differentiated(*self._wrapped(self.pieces), start, self.values, sparsity=colours)
        self.outputs = Outputs(outputs, self.values)
        self.mirror = None if mirror is None else image_map(mirror, self.node)
        self.symmetric = len(symmetries) > 0
        self.generators = [
            (f"symmetries[{i}]", image_map(s, self.node, "symmetries")) for i, s in enumerate(symmetries)
        ]
        if self.mirror is not None:
            self.generators.append(("mirror", self.mirror))
        refuse_no_group(self.generators, self.node)
        self.images, self.symmetric_for = images_of([f for _, f in self.generators], self.node), set()
        self.conditions: Conditions | None = None
        self.u0 = start
        if conditions:
            from .conditions import Conditions

            self.conditions = Conditions(list(conditions), self.functions, start)
            self.u0 = self.conditions.extended(start)
        self.dimension = len(self.u0)
        self.given_scale = given_scale(scale, self.node)
        if self.given_scale is not None and self.conditions is not None:
            self.given_scale = np.append(self.given_scale, np.ones(self.conditions.count))
        self.n_margins = self.pieces.count
        self.data = self
        self._check_start(start)
        self._check_rows(start)
        self._find_structure(start)
        if self.mirror is not None:
            self.symmetries = (Symmetry("symmetry-breaking", self._mirrored),)
        self.describe()  # registers the callables by their addresses

    def _find_structure(self, start: np.ndarray) -> None:
        dense = self._structure_at(start) == "dense"
        if self.spectrum == "flow":
            self.n_multipliers = self.node if dense else min(self.leading, self.node)
            if dense and self.conditions is not None:
                self.n_multipliers = self.node - self.conditions.count
        elif dense and self.dimension <= WATCHED:
            self.n_multipliers, self.detection = self.dimension, "real"
        else:
            self.n_multipliers, self.detection, self.many = NEAREST, "real", True
        if not dense and self.conditions is not None:
            raise ValueError(
                "conditions need a Jacobian that is an array; put them into F, with an unknown each"
            )

    def _mirrored(self, u: np.ndarray) -> np.ndarray:
        assert self.mirror is not None
        return np.append(self.mirror(u[: self.node]), u[self.node :])

    def of_unknowns(self, each: np.ndarray) -> np.ndarray:
        """Extend an array over the unknowns of F by 1 for the multiplier of each condition."""
        return np.append(each, np.ones(self.dimension - self.node, dtype=each.dtype))

    # ------------------------------------------------------------------ numerics
    def residuals(self, u: np.ndarray, p: float) -> np.ndarray:
        """Return F without its derivatives."""
        if self.conditions is not None:
            return self.equations(u, p)[0]
        return self.functions.value(u, p)

    def equations(
        self, u: np.ndarray, p: float
    ) -> tuple[np.ndarray, np.ndarray | csc_array | Operator, np.ndarray]:
        """Return F, dF/du and dF/dp."""
        f, u = self.functions, readonly(u)
        if self.preconditioner is not None:
            self.inverse = self.preconditioner(u, self.values.at(p))
        if self.conditions is not None:
            return self.conditions.equations(u, p, f, self.values)
        return f.value(u, p), f.jacobian(u, p), f.derivative(u, p)

    inverse: np.ndarray | Operator | None = None
    reference: np.ndarray | csc_array | None = None
    mixed_rows = True

    def preconditioner_at(self) -> np.ndarray | Operator | None:
        """Return the user's approximate inverse of dF/du at the last evaluation, or None."""
        return self.inverse

    def raw_spectrum(self, work: Linearised) -> np.ndarray:
        """Return the eigenvalues of dF/du, in units of the typical rate; with spectrum "none" the numbers that detect branch points (see :mod:`.spectra`)."""
        if not self.n_multipliers:
            return np.zeros(0)
        if self.detection == "real":
            if self.many and not self.close:
                return ZERO_SPECTRUM - self.algebra.distance_to_singular(self, work)
            return self.algebra.nearest_eigenvalues(self, work)
        rate = 1.0 if self.scales is None else self.scales.rate
        return self._eigenvalues(work) / rate

    def _eigenvalues(self, work: Linearised) -> np.ndarray:
        if not isinstance(work, DenseWork):
            from .large import sparse

            assert isinstance(work, sparse.SparseWork)
            return sparse.leading(self, work, self.n_multipliers, self.shift)
        if self.conditions is not None:
            return self.conditions.eigenvalues(work.jacobian)
        return without_roundoff(np.linalg.eigvals(work.jacobian))

    def blur(self, work: DenseWork | SparseWork) -> float:
        """Estimate how much rounding of dF/du moves a raw eigenvalue."""
        matrix = work.jacobian
        if isinstance(matrix, Operator):
            return 0.0
        rate = 1.0 if self.scales is None else self.scales.rate
        return rounding(matrix[: self.node, : self.node], self.sizes()[1][: self.node]) / rate

    def eigenvectors(self, u: np.ndarray, p: float, values: np.ndarray) -> np.ndarray:
        """Return eigenvectors of dF/du as columns, in the order of the given eigenvalues (by inverse iteration if dF/du is sparse)."""
        matrix = self.functions.jacobian(np.asarray(u, dtype=float)[: self.node], p)
        if isinstance(matrix, np.ndarray):
            every = values if len(values) else np.linalg.eigvals(matrix)
            return vectors_of(matrix, every)
        from .large import sparse

        return sparse.eigenvectors(matrix, values)

    def rates(self, work: DenseWork | SparseWork) -> list[float]:
        """Return the median magnitude of the eigenvalues as a list of one number; empty unless the spectrum is "flow"."""
        if self.spectrum != "flow":
            return []
        sizes = np.abs(self._eigenvalues(work))
        sizes = sizes[np.isfinite(sizes) & (sizes > 0.0)]
        return [float(np.median(sizes))] if len(sizes) else []

    def to_multipliers(self, spectrum: np.ndarray) -> np.ndarray:
        """Return eigenvalues in the equations' unit of time from raw ones."""
        if self.spectrum == "none":
            return np.zeros((*spectrum.shape[:-1], 0), dtype=complex)
        return np.asarray(spectrum, dtype=complex) * (1.0 if self.scales is None else self.scales.rate)

    # ------------------------------------------------------------------ pieces
    def with_pieces(self, pieces: Pieces) -> AlgebraicProblem:
        """Return the same problem with other signs of the switches."""
        other = self.against(self.parameter)
        other.pieces, other.functions = pieces, self.functions_in(pieces)
        other.reference = None
        return other

    # ------------------------------------------------------------------ identity and measures
    def canonical(self, u: np.ndarray, p: float) -> tuple[Any, np.ndarray]:
        """Return a key, and the first in dictionary order of u and its images."""
        u = np.asarray(u, dtype=float)
        key = ("algebraic", self.dimension, self.pieces.key)
        if not self.images:
            return key, u
        scale = np.ones(self.node) if self.scales is None else self.scales.unknowns[: self.node]
        best = smallest_image(u[: self.node], self.images, scale)
        return key, best if self.conditions is None else np.append(best, u[self.node :])

    @property
    def measure_names(self) -> tuple[str, ...]:
        """Names: the user's outputs, "norm", and the unknowns "u0", "u1", ..."""
        return (*self.outputs.names, "norm", *(f"u{i}" for i in range(self.node)))

    def measures(self, names: Sequence[str], u: np.ndarray, p: np.ndarray) -> dict[str, np.ndarray]:
        """Return the named measures, each of shape (m,), of m solutions."""
        u = np.atleast_2d(u)[:, : self.node]
        outputs = self.outputs.measures([name for name in names if name in self.outputs.names], u, p)
        return {**super().measures([name for name in names if name not in outputs], u, p), **outputs}

    # ------------------------------------------------------------------ motions of u' = F(u, p)
    def simulated_attractors(self, p: float, starts: int = 12) -> list[dict[str, Any]]:
        """Integrate u' = F from starts around u0, and list what they settle on, each once; empty unless the spectrum is "flow".

        "word" and "kind" of an entry are "equilibrium", "oscillation" or "escapes"; an equilibrium has its state, "u".
        """
        if self.spectrum != "flow" or self.node > LARGEST or self.node != len(self.u0):
            return []
        middle = np.asarray(self.u0, dtype=float)
        scales = self.scales
        size = np.maximum(np.abs(middle), 1.0 if scales is None else scales.unknowns)
        generator = np.random.default_rng(7)
        found: list[dict[str, Any]] = []
        for i in range(starts):
            spread = np.zeros(self.node) if i == 0 else generator.uniform(-SPREAD, SPREAD, self.node)
            kind, u = self._settled(middle + spread * size, p, size)
            new = {"word": kind, "periods": 0, "kind": kind}
            if kind == "equilibrium":
                new["u"] = [float(x) for x in u]
            if not any(_same_attractor(new, other, size) for other in found):
                found.append(new)
        return sorted(found, key=lambda one: (one["kind"], one.get("u", [])))

    def attractor(self, u: np.ndarray, p: float) -> dict[str, Any]:
        """Return a stable equilibrium as an entry of `simulated_attractors`."""
        place = [float(x) for x in u[: self.node]]
        return {"word": "equilibrium", "periods": 0, "kind": "equilibrium", "u": place}

    def _settled(self, u: np.ndarray, p: float, size: np.ndarray) -> tuple[str, np.ndarray]:
        """Integrate u' = F from u; return the kind of the attractor, and the equilibrium if it is one."""
        from scipy.integrate import LSODA

        def rate(t: float, x: np.ndarray) -> np.ndarray:
            try:
                return np.asarray(self.residuals(x, p), dtype=float)
            except (ArithmeticError, ValueError):
                return np.full(len(x), np.nan)

        with np.errstate(all="ignore"):
            if not rate(0.0, u).any():  # u is an equilibrium to the last bit, perhaps an unstable one
                u = u + SIMULATION.offset * size * (-1.0) ** np.arange(len(u))
            speed = float((np.abs(rate(0.0, u)) / size).max())
            span = 10.0 / speed if np.isfinite(speed) and speed > 0.0 else 10.0
            tolerances: dict[str, Any] = {"rtol": SIMULATION.relative, "atol": SIMULATION.absolute * size}
            solver = LSODA(rate, 0.0, u, np.inf, **tolerances)
            rest, rest_time = u, 0.0  # last state that was left by more than `still`, and its time
            for _ in range(PATIENCE):
                solver.step()
                x = solver.y
                if solver.status == "failed" or not float((np.abs(x) / size).max()) < SIMULATION.far:
                    return "escapes", u
                if float((np.abs(x - rest) / size).max()) > SIMULATION.at_rest:
                    rest, rest_time = x.copy(), solver.t
                elif solver.t - rest_time > span:
                    return "equilibrium", x.copy()
        return "oscillation", u

    # ------------------------------------------------------------------ files
    def describe(self) -> dict[str, Any]:
        """Return name, start, and the data from which `from_description` rebuilds the problem if F can be imported."""
        address, importable = addresses(self.given)
        special = (
            self.symmetric,
            self.conditions,
            self.pieces.count,
            self.outputs.names,
            self.functions.sparsity,
        )
        plain = not any(special)
        return {
            "name": self.name,
            "parameter": self.parameter,
            "spectrum": self.spectrum,
            "u0": self.u0[: self.node].tolist(),
            "p0": self.values.given(),
            "scale": None if self.given_scale is None else self.given_scale[: self.node].tolist(),
            "leading": self.leading,
            "shift": self.shift,
            "callables": address,
            "factory": "contvines.problems.algebraic:from_description" if importable and plain else None,
        } | ({"word": self.pieces.word} if self.pieces.count else {})


def _same_attractor(a: dict[str, Any], b: dict[str, Any], size: np.ndarray) -> bool:
    """Whether two entries of `simulated_attractors` are the same attractor."""
    if a["kind"] != b["kind"]:
        return False
    return "u" not in a or bool((np.abs(np.subtract(a["u"], b["u"])) < SIMULATION.offset * size).all())


def from_description(description: Mapping[str, Any], trust: bool = False) -> AlgebraicProblem | None:
    """Rebuild an AlgebraicProblem from the result of ``describe()``; None if its callables cannot be found."""
    functions = find_callables(description["callables"], trust)
    if functions is None:
        return None
    more = {key: description[key] for key in ("scale", "leading", "shift") if key in description}
    return AlgebraicProblem(
        functions.pop("F"),
        description["u0"],
        description["p0"],
        parameter=description["parameter"],
        spectrum=description["spectrum"],
        name=description["name"],
        **more,
        **functions,
    )
