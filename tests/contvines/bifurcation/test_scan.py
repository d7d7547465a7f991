"""Which segments are looked at again: signs at the ends, and parabolas through three points."""

import numpy as np
import pytest

from contvines.bifurcation import scan, scan_arrays
from contvines.bifurcation import segment_flags as bits
from contvines.bifurcation.multiplier_counts import counts
from contvines.bifurcation.segment_flags import Scanned, Symmetries
from contvines.continuation import aims
from contvines.continuation.arrays import Metric
from contvines.core.library import native

WAYS = {"fold": bits.FOLD, "border": bits.BORDER, "multiplier": bits.MULTIPLIER, "shallow": bits.SHALLOW,
        "damped": bits.DAMPED, "hump": bits.HUMP, "singular": bits.SINGULAR}  # fmt: skip


def marked(
    values, slopes=None, margins=None, multipliers=None, signs=None, kind=aims.MAP, real=True, curve=None
):
    """Names of what is marked, segment by segment, of points of a curve u(p)."""
    n = len(values)
    values = np.asarray(values, dtype=float)
    points = np.zeros((n, 1)) if curve is None else np.asarray(curve, dtype=float).reshape(n, 1)
    columns = [np.zeros((n, 0))]
    if multipliers is not None:
        spectrum = np.asarray(multipliers, dtype=complex).reshape(n, -1)
        columns.append(np.stack([spectrum.real, spectrum.imag], axis=-1).reshape(n, -1))
    first = columns[-1].shape[1]
    if margins is not None:
        columns.append(np.asarray(margins, dtype=float).reshape(n, -1))
    rows = np.ascontiguousarray(np.hstack(columns))
    flags, smallest = np.zeros(n - 1, np.int64), np.zeros(n)
    none = np.zeros((0, 1))
    chunk = Scanned(
        points,
        values,
        np.ones(n) if slopes is None else np.asarray(slopes, float),
        rows,
        np.ones(n) if signs is None else np.asarray(signs, float),
    )
    symmetries = Symmetries(np.zeros((0, 1), np.int64), none, none, np.zeros(1), np.zeros((2, 0, 1)))
    metric = Metric(np.ones(2), np.ones(2), 1.0, 1.0)
    scan_arrays.mark_segments(chunk, first, kind, real, 1e-9, metric, symmetries, flags, smallest)
    if native():
        again, least = np.zeros_like(flags), np.zeros(n)
        scan.in_native(chunk, first, kind, real, 1e-9, metric, symmetries, again, least)
        np.testing.assert_array_equal(again, flags)
        np.testing.assert_array_equal(least, smallest)
    return [{name for name, bit in WAYS.items() if flag & bit} for flag in flags], smallest


def test_a_dip_between_points_marks_the_segments_on_both_sides():
    """Of a margin (p - 0.24)^2 - 1e-4: below zero between the third and the fourth point only."""
    p = np.array([0.0, 0.1, 0.2, 0.3, 0.45, 0.6])
    for name, given in {
        "shallow": {"margins": (p - 0.24) ** 2 - 1e-4},
        "damped": {"multipliers": np.exp(-((p - 0.24) ** 2 - 1e-4))},
        "hump": {"slopes": (p - 0.24) ** 2 - 1e-4},
    }.items():
        found, _ = marked(p, **given)
        assert name in found[2], name
        assert name not in found[0] and name not in found[4], name
        # each parabola through three points is asked: round the second of them, and round the third
        assert name in found[1] and name in found[3], name


def test_uneven_steps_count():
    """A parabola that dips between points 0, 0.1, 0.4, and would not with the lengths in the other order."""
    p = np.array([0.0, 0.1, 0.4])
    margins = (p - 0.21) ** 2 - 1e-3
    assert ["shallow" in found for found in marked(p, margins=margins)[0]] == [True, True]
    swapped, _ = marked([0.0, 0.3, 0.4], margins=margins)
    a, b = (margins[1] - margins[0]) / 0.3, (margins[2] - margins[1]) / 0.1
    bend, slope = (b - a) / 0.4, (a * 0.1 + b * 0.3) / 0.4
    lowest = margins[1] - slope**2 / (4.0 * bend)
    assert ("shallow" in swapped[0]) == (bend > 0.0 and -0.3 < -0.5 * slope / bend < 0.1 and lowest < 0.0)


def test_uneven_steps_count_for_slopes():
    """(p - 0.2)^2 - 1e-4 at 0, 0.1, 0.3: below zero between the last two; with the lengths exchanged it would not be."""
    p = np.array([0.0, 0.1, 0.3])
    assert ["hump" in found for found in marked(p, slopes=(p - 0.2) ** 2 - 1e-4)[0]] == [True, True]
    exchanged, _ = marked([0.0, 0.2, 0.3], slopes=(p - 0.2) ** 2 - 1e-4)
    assert not any("hump" in found for found in exchanged)


def test_a_long_ago_dip_is_forgotten():
    p = np.arange(7.0)
    damping = np.array([0.5, 0.1, 0.02, 0.3, 0.4, 0.5, 0.6])
    found, _ = marked(p, multipliers=np.exp(-damping))
    assert not any("damped" in segment for segment in found[3:])


@pytest.mark.parametrize(("past", "counted"), [(1e-12, False), (1e-9, True), (1e-6, True), (1e-2, True)])
def test_multipliers_just_past_the_circle(past, counted):
    """Those of a conservative system lie on the circle up to rounding: no crossing; further out they are."""
    for inside, outside in ((0.9, 1.0 + past), (-0.9, -1.0 - past), (0.9j, 1j * (1.0 + past))):
        spectrum = np.array([[inside, np.conj(inside)], [outside, np.conj(outside)]])
        if not np.imag(inside):
            spectrum[:, 1] = 0.1
        assert ("multiplier" in marked([0.0, 1.0], multipliers=spectrum)[0][0]) is counted
        assert bool(counts(spectrum, "map")[1].sum()) is counted
    for outside in (past, past + 1j):
        spectrum = np.array([[-0.1, -0.2], [outside, np.conj(outside) if np.imag(outside) else -0.2]])
        if np.imag(outside):
            spectrum[0] = [-0.1 + 1j, -0.1 - 1j]
        assert ("multiplier" in marked([0.0, 1.0], multipliers=spectrum, kind=aims.FLOW)[0][0]) is counted
        assert bool(counts(spectrum, "flow")[1].sum()) is counted


@pytest.mark.parametrize(("margin", "lost"), [(0.0, False), (-1e-14, False), (-1e-11, True), (-1e-3, True)])
def test_margins_just_past_zero(margin, lost):
    found, smallest = marked([0.0, 1.0], margins=[[0.3, 1.0], [0.2, margin]])
    assert ("border" in found[0]) is lost and smallest.tolist() == [0.3, margin]
    again, _ = marked([0.0, 1.0], margins=[[0.2, margin], [0.3, 1.0]], real=False)
    assert ("border" in again[0]) is lost  # a virtual branch becomes real
    assert "border" not in marked([0.0, 1.0], margins=[[0.2, margin], [0.3, 1.0]])[0][0]


def test_the_smallest_of_many_margins_passes_over_what_is_none():
    draw = np.random.default_rng(4)
    for width in range(1, 11):
        margins = draw.normal(size=(6, width))
        margins[draw.random((6, width)) < 0.3] = np.nan
        _, smallest = marked(np.arange(6.0), margins=margins)
        expected = [min([m for m in row if m == m], default=np.inf) for row in margins]
        assert smallest.tolist() == expected


def test_folds_and_singular_points():
    found, _ = marked(np.arange(5.0), slopes=[1.0, 0.2, -0.3, -0.4, -0.5], signs=[1, 1, 1, -1, -1])
    assert ["fold" in segment for segment in found] == [False, True, False, False]
    assert ["singular" in segment for segment in found] == [False, False, True, False]
    vertical, _ = marked(np.arange(3.0), slopes=[1e-12, -1e-12, 1e-12])
    assert not any("fold" in segment for segment in vertical)


@pytest.mark.parametrize("bend", [-0.3, 0.3])
def test_two_folds_between_two_points_show_in_the_chord(bend):
    """p(s) = bend s + s^3 - 1.5 s^2 + 0.5 s...: a cubic on [0, 1] with slopes of one sign at its ends."""
    cubic = np.polynomial.Polynomial([0.0, 0.7 + bend, -1.5, 1.0])
    s = np.array([0.0, 1.0])
    turning = [x.real for x in cubic.deriv().roots() if abs(x.imag) < 1e-12 and 0.0 < x.real < 1.0]
    length = np.sqrt(1.0 - (cubic(1.0) - cubic(0.0)) ** 2)
    found, _ = marked(cubic(s), slopes=cubic.deriv()(s), curve=[0.0, length])
    assert ("hump" in found[0]) is (len(turning) == 2)
