"""How a machine's numbers follow the one parameter that varies.

The numbers that the maps read are products of powers of the named parameters. Of a machine described by its numbers each parameter
is one of them; a physical quantity may move several: the half-width of the cavity changes the dimensionless gravity and
forcing together. While one parameter p varies, number j is ``path[0, j] * p**path[1, j]``, or stays where ``path[1, j]`` is 0.
"""

from __future__ import annotations

import numpy as np


def place(params, path, p, out):
    """The numbers at p, then their derivatives with respect to p, into `out` (2 P,)."""
    count = params.shape[0]
    for j in range(count):
        power = path[1, j]
        if power == 0.0:
            out[j] = params[j]
            out[count + j] = 0.0
        elif power == 1.0:
            out[j] = path[0, j] * p
            out[count + j] = path[0, j]
        else:
            out[j] = path[0, j] * p**power
            out[count + j] = power * path[0, j] * p ** (power - 1.0)


def assign(data, other, value):
    """Give the parameter that varies in `other` a value in `data`, in place.

    Parameters
    ----------
    data, other : CycleData
        Of two problems of one machine.
    value : float
    """
    index = other.active
    params, path, active, amounts, law = data.params, data.path, data.active, data.amounts, data.law
    amounts[index] = value
    if law.shape[0] == 0:
        params[index] = value
        return
    for j in range(params.shape[0]):
        product = law[0, j]
        rest = law[0, j]
        for k in range(amounts.shape[0]):
            power = law[k + 1, j]
            if power != 0.0:
                factor = amounts[k] if power == 1.0 else amounts[k] ** power
                product *= factor
                if k != active:
                    rest *= factor
        params[j] = product
        path[0, j] = rest


def products(law: np.ndarray, amounts: np.ndarray) -> np.ndarray:
    """The numbers (P,) as products of powers of amounts (Q,): `law` (Q + 1, P) has factors, then exponents."""
    return law[0] * np.prod(amounts[:, None] ** law[1:], axis=0)


def single(count: int, index: int) -> np.ndarray:
    """The path (2, count) of a parameter that is the number `index` itself."""
    path = np.zeros((2, count))
    path[:, index] = 1.0
    return path


def along(path: np.ndarray, params: np.ndarray, p: np.ndarray | float) -> np.ndarray:
    """The numbers at each p: (P,) for one, (m, P) for an array (m,)."""
    value: float | np.ndarray
    if isinstance(p, float) or np.ndim(p) == 0:
        found, value = params.copy(), float(p)
    else:
        value = np.asarray(p, dtype=float)
        found = np.empty((*value.shape, params.size))
        found[...] = params
    factors, powers = path.tolist()
    for j, power in enumerate(powers):
        if power != 0.0:
            factor = factors[j]
            found[..., j] = factor * value if power == 1.0 else factor * value**power
    return found
