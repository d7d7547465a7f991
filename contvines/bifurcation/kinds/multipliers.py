"""Multipliers that pass the unit circle (eigenvalues the imaginary axis): period doubling, symmetry breaking, Neimark-Sacker, Hopf.

Each test function is the k-th largest multiplier of a sort, so that two that cross at once are two special points.
"""

from __future__ import annotations

from functools import partial

import numpy as np

from ...continuation.engine import Engine, Solved
from ...continuation.layout import SORTS, aim_at_multiplier
from ...problems.abilities import Adaptive
from ..kind import Classified, Kind, Point, PointOnBranch, Test
from ..locate import Segment
from ..normal_forms.criticality import near_resonance, pair_form

JUMP = 0.05  # change of a multiplier's logarithm over a small part of a segment: it has come from elsewhere


def passing(segment: Segment, sort: str) -> list[Test]:
    """One test for each multiplier of a sort ("plus", "minus", "pair") that is past the circle at one end only."""
    engine, place = segment.engine, tuple(SORTS).index(sort)
    one, other = segment.counts[0][place], segment.counts[1][place]
    return [
        Test(aim_at_multiplier(engine.m, engine.detection, sort, k), k, JUMP)
        for k in range(min(one, other) + 1, max(one, other) + 1)
    ]


def flips(segment: Segment, kind: str) -> list[Test]:
    """Multipliers that pass -1, where the problem says that this is what they mean.

    Where a pair of them meets on the real axis, or leaves it, their ranks tell nothing; of cycles on meshes the product of all distances from -1 is continuous
    there, as none passes through infinity.
    """
    engine = segment.engine
    if engine.problem.flip_kind != kind:
        return []
    negative = [
        int(((spectrum.imag == 0.0) & (spectrum.real < 0.0)).sum())
        for spectrum in (engine.spectrum(segment.a.row), engine.spectrum(segment.b.row))
    ]
    if not engine.adaptive or negative[0] == negative[1]:
        return passing(segment, "minus")
    change = segment.counts[1][1] - segment.counts[0][1]
    return [Test(partial(_from_minus_one, engine), 1, JUMP)] if change % 2 else []


def _from_minus_one(engine: Engine, point: Solved) -> float:
    """The product of (1 + multiplier) / (1 + |multiplier|): its sign is that of det(M + 1)."""
    spectrum = engine.spectrum(point.row)
    return float(np.real(np.prod((1.0 + spectrum) / (1.0 + np.abs(spectrum)))))


def alone_at_circle(point: Point) -> bool:
    """Whether the multiplier nearest to -1 is there: if another one is nearer to it than that, two have met beside the circle and left the axis."""
    assert isinstance(point, PointOnBranch)
    spectrum = point.engine.spectrum(point.solved.row)
    gaps = np.nan_to_num(np.abs(spectrum + 1.0), nan=np.inf)
    nearest = int(np.argmin(gaps))
    others = np.abs(np.delete(spectrum, nearest) - spectrum[nearest])
    return bool(gaps[nearest] <= max(point.engine.settings.critical, np.nanmin(others, initial=np.inf)))


def pairs(segment: Segment, spectrum: str) -> list[Test]:
    """Complex pairs that pass the circle (the imaginary axis)."""
    return passing(segment, "pair") if segment.engine.detection == spectrum else []


def classify_pair(point: PointOnBranch) -> Classified:
    """The first Lyapunov coefficient, from derivatives of the equations; of cycles on a mesh, whose unknowns are more than the states of
    a map, from the problem's own form.
    """
    problem = point.problem
    if problem.spectrum not in ("map", "flow"):
        return Classified()
    if not (isinstance(problem, Adaptive) and problem.spectrum == "map"):
        return pair_form(problem, point.u, point.value, point.engine.spectrum(point.solved.row))
    upper = point.multipliers[np.imag(point.multipliers) > 0.0]
    if not len(upper):
        return Classified()
    multiplier = complex(upper[np.argmin(np.abs(np.abs(upper) - 1.0))])
    form, remarks = (
        problem.normal_form("neimark-sacker", point.u, point.value, multiplier),
        near_resonance(multiplier),
    )
    if form is None:
        return Classified(remarks=remarks)
    return Classified("supercritical" if form[0] < 0.0 else "subcritical", form[0], remarks)


#: in the order in which they are asked
KINDS = (
    Kind(
        "symmetry-breaking",
        "SB",
        text="symmetry breaking",
        marker="D",
        filled=False,
        tests=partial(flips, kind="symmetry-breaking"),
        verify=alone_at_circle,
        locus="flip",
        leaves="doubled",
        without="a pair of solutions of less symmetry leaves here; this problem has no equations for it",
    ),
    Kind(
        "period-doubling",
        "PD",
        text="period doubling",
        marker="^",
        filled=False,
        tests=partial(flips, kind="period-doubling"),
        verify=alone_at_circle,
        locus="flip",
        leaves="doubled",
        without="a solution of twice the period leaves here; this problem has no equations for it",
    ),
    Kind(
        "neimark-sacker",
        "NS",
        text="Neimark-Sacker",
        marker="p",
        filled=False,
        tests=partial(pairs, spectrum="map"),
        classify=classify_pair,
        locus="pair",
        leaves="circle",
        nothing="an invariant circle leaves a Neimark-Sacker point, no branch of cycles; its circles() follow it",
    ),
    Kind(
        "hopf",
        "HB",
        text="Hopf",
        marker="h",
        filled=False,
        tests=partial(pairs, spectrum="flow"),
        classify=classify_pair,
        locus="pair",
        leaves="cycles",
        nothing="a branch of limit cycles leaves a Hopf point; this problem has equations for equilibria only",
    ),
)
