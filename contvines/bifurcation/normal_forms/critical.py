"""Normal forms at points of codimension two, as data: critical directions, monomials of the normal form, and coefficients computed from them.

With w, w1, w2 real and z complex coordinates on the critical directions, of unit length as in
:mod:`contvines.bifurcation.normal_forms.coefficients`; maps w -> ..., flows w' = ...:

    cusp                 w + c w^3,  w' = c w^3
    generalized flip     -w + c w^3 + d w^5, at c = 0: for d > 0 the doubled cycles that are born are stable
    Chenciner            m z (1 + c1 |z|^2 + c2 |z|^4):  d2 = Re c2 + (Im c1)^2 / 2
    generalized Hopf     i omega z + c1 z |z|^2 + c2 z |z|^4:  l2 = Re c2 / omega
    resonance 1:1        (w1 + w2, w2 + a w1^2 + b w1 w2);  Bogdanov-Takens (w2, a w1^2 + b w1 w2)
    resonance 1:2        (-w1 + w2, -w2 + c w1^3 + d w1^2 w2)
    resonance 1:3        m z + B z*^2 + C z |z|^2:  b = |B|, a = (Re(C / m) / |B|^2 - 1) / 3
    resonance 1:4        i z + C z |z|^2 + D z*^3:  A = -i C / |D|
    fold-flip            (w1 + a w1^2 / 2 + b w2^2 / 2 + c w1^3 / 6 + d w1 w2^2 / 2, -w2 + e w1 w2 + f w1^2 w2 / 2 + g w2^3 / 6)
    fold and pair        w' = b w^2 + c |z|^2 + g1 w^3 + g2 w |z|^2,  z' = i omega z + D w z + h1 w^2 z + h2 z |z|^2 (zero-Hopf; of
                         maps in the same way, with h and D divided by m):  s = sign(b c), theta = Re D / b, and of flows
                         e = Re[h1 + D (Re h2 / c + g2 / (2 c) - 3 g1 / (2 b)) - h2 b / c], the cubic coefficient that remains after
                         changes of time and coordinates
    two pairs, flip and pair   r1' = r1 (p11 r1^2 + p12 r2^2), r2' = r2 (p21 r1^2 + p22 r2^2) to third order (growth of the amplitudes
                         per period for maps):  theta = p12 / p22, delta = p21 / p11

Source: Kuznetsov, Elements of Applied Bifurcation Theory, 3rd ed., chapters 8 and 9; Kuznetsov and Meijer, SIAM J. Sci. Comput. 26
(2005) 1932; Kuznetsov, Meijer and van Veen, Int. J. Bifurc. Chaos 14 (2004) 2253, for fold-flip.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from .coefficients import Forms, in_phase
from .manifold import Monomial, Series, reduced

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence


OTHER = 0.1  # distance between a multiplier and a strong resonance from which it is not this resonance (of a half map, for example)
#: for flows: power of the rate with which each coefficient scales; zero for those not listed
RATES: dict[str, dict[str, int]] = {
    "cusp": {"c": 1},
    "bogdanov-takens": {"a": 2, "b": 1},
    "zero-hopf": {"b": 1, "c": 1, "e": 1},
    "double-hopf": {"p11": 1, "p12": 1, "p21": 1, "p22": 1},
}
CONJUGATE = np.array([[1.0, 1j], [1.0, -1j]])
THIRD, QUARTER = np.exp(2j * np.pi / 3.0), 1j


def normal_form(kind: str, forms: Forms, pairs: list[complex]) -> dict[str, float]:
    """Compute the normal-form coefficients at a point of codimension two, by name; empty for kinds without a normal form.

    Parameters
    ----------
    kind : str
        Kind of the point.
    forms : Forms
        Equations at the point.
    pairs : list of complex
        Critical multipliers (of a flow: eigenvalues) with positive imaginary part, the most critical one first.

    Raises
    ------
    ValueError
        If the equations cannot be evaluated near the point.
    """
    found = _normal_form(kind, forms, [pair / forms.rate for pair in pairs])
    powers = RATES.get(kind, {}) if forms.flow else {}
    return {name: value * forms.rate ** powers.get(name, 0) for name, value in found.items()}


def _normal_form(kind: str, forms: Forms, pairs: list[complex]) -> dict[str, float]:
    """Compute the coefficients in the unit of time of `forms`; `pairs` are in this unit, too."""
    if kind == "cusp":
        return {"c": forms.cubic(0.0 if forms.flow else 1.0).value / forms.rate}
    if kind in ("generalized-period-doubling", "degenerate-symmetry-breaking"):
        return _flip(forms)
    if kind in ("bogdanov-takens", "resonance-1-1", "resonance-1-2", "resonance-1-3", "resonance-1-4"):
        return _resonance(forms, pairs)
    if kind in ("fold-flip", "fold-symmetry-breaking"):
        return _fold_flip(forms)
    if not pairs:
        return {}
    if kind in ("generalized-hopf", "chenciner"):
        return _degenerate_pair(forms, pairs[0])
    if kind in ("zero-hopf", "fold-neimark-sacker"):
        return _fold_and_pair(forms, pairs[0])
    if kind in ("flip-neimark-sacker", "symmetry-breaking-neimark-sacker"):
        return _amplitudes(forms, [-1.0, *_pair_on_boundary(forms, pairs[0])])
    if kind in ("double-hopf", "double-neimark-sacker") and len(pairs) > 1:
        return _amplitudes(forms, [*_pair_on_boundary(forms, pairs[0]), *_pair_on_boundary(forms, pairs[1])])
    return {}


def _on_boundary(forms: Forms, value: complex) -> complex:
    """Move a critical value exactly onto the circle, or of a flow the imaginary axis."""
    return 1j * abs(value.imag) if forms.flow else value / abs(value)


def _pair_on_boundary(forms: Forms, value: complex) -> list[complex]:
    """Return the pair of a critical value, exactly on the circle or the axis."""
    value = _on_boundary(forms, value)
    return [value, value.conjugate()]


def _simple(
    forms: Forms,
    values: Sequence[complex],
    stay: list[tuple[int, Monomial]],
    degree: int,
    wanted: Callable[[Series], dict[str, float]],
) -> dict[str, float]:
    """Reduce to the directions of simple multipliers.

    Parameters
    ----------
    forms : Forms
    values : sequence of complex
        Critical multipliers; conjugate ones are neighbours.
    stay : list of (int, Monomial)
        Terms of the normal form; terms of one of a pair are added for the other one.
    degree : int
    wanted : callable
        Coefficients of the normal form -> result by name.
    """
    m = len(values)
    vectors, real, partner = [], np.zeros((m, m), dtype=complex), list(range(m))
    i = 0
    while i < m:
        vector, _ = forms.null(values[i])
        if np.imag(values[i]) != 0.0:
            vector = in_phase(vector)
            vectors += [vector, vector.conj()]
            real[i : i + 2, i : i + 2] = CONJUGATE
            partner[i], partner[i + 1] = i + 1, i
            i += 2
        else:
            vector = np.real(vector)
            vectors.append(vector if vector[np.argmax(np.abs(vector))] > 0.0 else -vector)
            real[i, i] = 1.0
            i += 1
    every = list(stay)
    for component, exponents in stay:
        mirrored = (partner[component], tuple(exponents[partner[j]] for j in range(m)))
        if mirrored not in every:
            every.append(mirrored)
    return reduced(forms, np.array(vectors).T, np.diag(values), real, every, degree, wanted)


def _flip(forms: Forms) -> dict[str, float]:
    """Generalized flip."""
    stay = [(0, (3,)), (0, (5,))]
    return _simple(forms, [-1.0], stay, 5, lambda N: {"c": N[(3,)][0].real, "d": N[(5,)][0].real})


def _double(forms: Forms, factor: float, degree: int, names: tuple[str, str]) -> dict[str, float]:
    """Double multiplier with a Jordan block: Bogdanov-Takens, resonances 1:1 and 1:2."""
    first, second = (degree, 0), (degree - 1, 1)
    return reduced(
        forms,
        forms.chain(factor),
        np.array([[factor, 1.0], [0.0, factor]]),
        np.eye(2),
        [(1, first), (1, second)],
        degree,
        lambda N: {names[0]: N[first][1].real, names[1]: N[second][1].real},
    )


def _resonance(forms: Forms, pairs: list[complex]) -> dict[str, float]:
    """Compute the form of the resonance that the multipliers of the problem's own period have; for half maps it may differ from the kind's name."""
    if forms.flow:
        return _double(forms, 0.0, 2, ("a", "b"))
    value = pairs[0] if pairs else None
    for place in (THIRD, QUARTER):
        if value is not None and abs(value - place) < OTHER:
            return _third(forms) if place == THIRD else _fourth(forms)
    smallest = {
        factor: np.linalg.svd(forms.closed_by(factor), compute_uv=False)[-1] for factor in (1.0, -1.0)
    }
    factor = min(smallest, key=lambda key: smallest[key])
    if value is not None and abs(value - factor) > OTHER:
        return {}  # a half map, for which the resonance is weak
    return _double(forms, factor, 2, ("a", "b")) if factor > 0.0 else _double(forms, factor, 3, ("c", "d"))


def _third(forms: Forms) -> dict[str, float]:
    """Resonance 1:3."""

    def wanted(N: Series) -> dict[str, float]:
        b, c = N[(0, 2)][0], N[(2, 1)][0]
        return {"b": abs(b), "a": ((c / THIRD).real / abs(b) ** 2 - 1.0) / 3.0}

    return _simple(forms, [THIRD, THIRD.conjugate()], [(0, (0, 2)), (0, (2, 1))], 3, wanted)


def _fourth(forms: Forms) -> dict[str, float]:
    """Resonance 1:4."""

    def wanted(N: Series) -> dict[str, float]:
        A = -1j * N[(2, 1)][0] / abs(N[(0, 3)][0])
        return {"A_re": A.real, "A_im": A.imag}

    return _simple(forms, [QUARTER, QUARTER.conjugate()], [(0, (2, 1)), (0, (0, 3))], 3, wanted)


def _degenerate_pair(forms: Forms, value: complex) -> dict[str, float]:
    """Chenciner point, or generalized Hopf point."""
    on_boundary = _on_boundary(forms, value)

    def wanted(N: Series) -> dict[str, float]:
        first, second = N[(2, 1)][0], N[(3, 2)][0]
        if forms.flow:
            return {"l1": first.real / on_boundary.imag, "l2": second.real / on_boundary.imag}
        first, second = first / on_boundary, second / on_boundary
        return {"d": first.real, "d2": second.real + 0.5 * first.imag**2}

    return _simple(forms, _pair_on_boundary(forms, value), [(0, (2, 1)), (0, (3, 2))], 5, wanted)


def _fold_flip(forms: Forms) -> dict[str, float]:
    """Fold-flip."""
    stay = [(0, (2, 0)), (0, (0, 2)), (1, (1, 1)), (0, (3, 0)), (0, (1, 2)), (1, (2, 1)), (1, (0, 3))]
    factors = (2.0, 2.0, 1.0, 6.0, 2.0, 2.0, 6.0)

    def wanted(N: Series) -> dict[str, float]:
        return {
            name: factor * N[exponents][i].real
            for name, factor, (i, exponents) in zip("abecdfg", factors, stay)
        }

    return _simple(forms, [1.0, -1.0], stay, 3, wanted)


def _fold_and_pair(forms: Forms, value: complex) -> dict[str, float]:
    """Fold and pair."""
    stay = [(0, (2, 0, 0)), (0, (0, 1, 1)), (0, (3, 0, 0)), (0, (1, 1, 1))]
    stay += [(1, (1, 1, 0)), (1, (2, 1, 0)), (1, (0, 2, 1))]
    turn = 1.0 if forms.flow else _on_boundary(forms, value)

    def wanted(N: Series) -> dict[str, float]:
        b, c, g1, g2 = (N[exponents][0].real for _, exponents in stay[:4])
        D, h1, h2 = (N[exponents][1] / turn for _, exponents in stay[4:])
        found = {"b": b, "c": c, "s": float(np.sign(b * c)), "theta": D.real / b}
        if forms.flow:
            bent = h1 + D * (h2.real / c + g2 / (2.0 * c) - 1.5 * g1 / b) - h2 * b / c
            found["e"] = bent.real
        return found

    return _simple(forms, [0.0 if forms.flow else 1.0, *_pair_on_boundary(forms, value)], stay, 3, wanted)


def _amplitudes(forms: Forms, values: list[complex]) -> dict[str, float]:
    """Flip and pair, or two pairs: growth of the two amplitudes."""
    first = 1 if len(values) == 3 else 2  # number of coordinates of the first amplitude
    own = (2, 1) if first == 2 else (3,)
    other = (1, 1) if first == 2 else (2,)
    linear = (1, 0) if first == 2 else (1,)
    none = (0,) * first
    stay = [
        (0, (*own, 0, 0)),
        (0, (*linear, 1, 1)),
        (first, (*other, 1, 0)),
        (first, (*none, 2, 1)),
    ]

    def wanted(N: Series) -> dict[str, float]:
        turns = (1.0, 1.0) if forms.flow else (values[0], values[first])
        p = [float((N[exponents][i] / turns[0 if i == 0 else 1]).real) for i, exponents in stay]
        return {
            "p11": p[0],
            "p12": p[1],
            "p21": p[2],
            "p22": p[3],
            "theta": p[1] / p[3],
            "delta": p[2] / p[0],
        }

    return _simple(forms, values, stay, 3, wanted)
