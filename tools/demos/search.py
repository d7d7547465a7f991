"""Search for special points that are missing in the table: Newton's method for their equations from many random starts.

    python -m tools.demos.search [NAME...]

Points that are not in the table are printed. Those that are known belong to branches that are not connected to the start
(adaptx, lorenz 84 and two patches have some). For maps only fixed points are searched for, no longer cycles.
"""

from __future__ import annotations

import json
import sys
import warnings
from typing import Any

import numpy as np
from scipy.optimize import fsolve

from . import listed, maps
from .demo import Demo
from .make_table import TABLE

TRIES, LARGEST = 150, 6
KINDS = {
    "det": ("fold", "branch-point", "symmetry-breaking"),
    "hopf": ("hopf",),
    "flip": ("period-doubling",),
    "circle": ("neimark-sacker",),
}


def jacobian(f: Any, u: np.ndarray, p: float) -> np.ndarray:
    """Return dF/du by complex steps."""
    columns = []
    for j in range(len(u)):
        shifted = u.astype(complex)
        shifted[j] += 1e-30j
        columns.append(np.imag(f(shifted, p)) / 1e-30)
    return np.array(columns).T


def condition(kind: str, A: np.ndarray) -> float:
    """Return the function of the Jacobian that vanishes at a special point."""
    n = len(A)
    if kind == "det":
        return float(np.linalg.det(A))
    if kind == "flip":
        return float(np.linalg.det(A + 2.0 * np.eye(n)))
    c = np.poly(A + np.eye(n) if kind == "circle" else A)
    if n == 1:
        return 1.0
    if kind == "circle":
        return float(c[2] - 1.0 if n == 2 else 1.0 - c[2] + c[1] * c[3] - c[3] ** 2)
    entry = lambda i, j: c[2 * j - i + 1] if 0 <= 2 * j - i + 1 <= n else 0.0  # noqa: E731
    return float(np.linalg.det([[entry(i, j) for j in range(n - 1)] for i in range(n - 1)]))


def believed(kind: str, A: np.ndarray) -> bool:
    """Whether a zero of the condition is a special point (and no neutral saddle)."""
    if kind == "hopf":
        values = np.linalg.eigvals(A)
        large = np.abs(values).max()
        return bool(np.any((np.abs(values.real) < 1e-5 * large) & (values.imag > 1e-3 * large)))
    if kind == "circle":
        values = np.linalg.eigvals(A + np.eye(len(A)))
        return bool(np.any((np.abs(np.abs(values) - 1.0) < 1e-5) & (values.imag > 1e-4)))
    sizes = np.linalg.svd(A + 2.0 * np.eye(len(A)) if kind == "flip" else A)[1]
    return bool(sizes[-1] < 1e-4 * sizes[0])


def missing(demo: Demo, rows: list[dict[str, Any]]) -> dict[str, list[np.ndarray]]:
    """Return special points in the interval, and not far from the known ones, that are not in the table."""
    n, rng = len(demo.u), np.random.default_rng(0)
    f = demo.function if demo.kind == "flow" else lambda u, p: demo.function(u, p) - u
    known = [(row["kind"], row["value"], np.array(row["u"])) for row in rows if row["cycle"] == 1]
    places = np.array([u for _, _, u in known] or [demo.u])
    low, high = places.min(axis=0), places.max(axis=0)
    span = np.maximum(high - low, 0.1 * np.maximum(np.abs(low), np.abs(high)))
    span[span == 0.0] = 1.0
    left, right = demo.within
    images = [np.eye(n), demo.options.get("mirror", np.eye(n))]
    found: dict[str, list[np.ndarray]] = {}
    kinds = ("det", "hopf") if demo.kind == "flow" else ("det", "flip", "circle")
    for kind in kinds[:1] if demo.options.get("spectrum") == "none" else kinds:

        def system(z: np.ndarray, kind: str = kind) -> np.ndarray:
            return np.append(f(z[:n], z[n]), condition(kind, jacobian(f, z[:n], z[n])))

        for _ in range(TRIES):
            start = low - 0.7 * span + rng.random(n) * (high - low + 1.4 * span)
            z, info, _, _ = fsolve(
                system, np.append(start, left + rng.random() * (right - left)), full_output=True, xtol=1e-13
            )
            if not (np.abs(info["fvec"]).max() < 1e-8 and left <= z[n] <= right):
                continue
            if not believed(kind, jacobian(f, z[:n], z[n])):
                continue
            if any(
                k in KINDS[kind]
                and abs(p - z[n]) < 2e-3 * (right - left)
                and any((np.abs(u - image @ z[:n]) < 2e-2 * (span + np.abs(u))).all() for image in images)
                for k, p, u in known
            ):
                continue
            if not any(
                np.abs(z - other).max() < 1e-3 * (1.0 + np.abs(z).max()) for other in found.get(kind, [])
            ):
                found.setdefault(kind, []).append(z)
    return found


def main(names: list[str]) -> None:
    """Search for all demos, or for some."""
    warnings.simplefilter("ignore")
    np.seterr(all="ignore")
    table = json.loads(TABLE.read_text(encoding="utf-8"))
    for demo in [*listed.DEMOS, *maps.DEMOS]:
        if len(demo.u) <= LARGEST and (not names or demo.name in names):
            print(demo.name, missing(demo, table[demo.name]) or "complete", flush=True)


if __name__ == "__main__":
    main(sys.argv[1:])
