"""From circle to circle: by growing amplitude at first, then along the curve of circles where the amplitude turns back.

Unknowns of a circle are its points, its rotation number and the parameter. Near its birth the amplitude is a good parameter of the family. Near a
saddle, where circles born beside a strong resonance end, the motion lingers and its first harmonic shrinks again, while the circle goes
on: there each circle is looked for on the plane across the last change of (amplitude, rotation, parameter).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from .birth import Birth
from .invariance import Condition, Curve, Frame, at_value, between, first_harmonic, of_amplitude, solve
from .section import Section
from .settings import CIRCLES

FEWEST, MOST = 17, 257  # points of a circle
LESS = 0.25  # by which twice the points make the last harmonics smaller at least: a circle that meets a border has no more derivatives to show
# first amplitude relative to the last one, factors from one to the next
FIRST, GROWTH, SLOWEST = 0.04, 1.35, 1.05
LONGEST = 0.3  # step along the family, where amplitude, rotation and distance from the birth count 1 each
# times the step: longer ones leap over motions locked at a rational rotation
TRIES = (1.0, 0.5, 1.6, 0.25, 2.4, 0.12, 0.06)
LEAST = 0.01  # steps below this go nowhere
# distance of a rotation number from n/q, times q^2: where it is that near, motions lock; largest q
LOCKED, PERIODS = 0.05, 40
# of the radius: where motions so far outside do not come back to the section, no larger circle is seen there
OUTWARDS = 0.1
LINGERS = 0.5  # part of its rotation at birth below which a circle's motion is said to linger

Sections = Callable[[float], Section]


@dataclass(frozen=True, eq=False)
class Reach:
    """How far circles are followed.

    amplitude : float
        The largest one, where no end is given.
    to : float or None
        Parameter value.
    side : float
        1 where circles lie above the parameter of their birth, -1 below.
    count : int
        How many at most.
    name : str
        Of the parameter.
    """

    amplitude: float
    to: float | None
    side: float
    count: int
    name: str


def followed(section: Sections, birth: Birth, reach: Reach) -> tuple[list[Curve], str]:
    """Circles of growing amplitude, then along their family; and why there are no more."""
    found, ended = _growing(section, birth, reach)
    if ended is None:
        ended = _onwards(section, birth, reach, found)
    return found, ended


def _growing(section: Sections, birth: Birth, reach: Reach) -> tuple[list[Curve], str | None]:
    """By their amplitude, until that will not do; then the sentence is None."""
    amplitude, factor, points = FIRST * reach.amplitude, GROWTH, FEWEST
    found: list[Curve] = []
    while len(found) < reach.count:
        guess = _larger(found, birth, amplitude, points)
        curve = _smooth(section, guess, birth.frame, of_amplitude(amplitude))
        if curve is None or _torn(section, curve, birth.frame):
            if not found:
                amplitude *= 0.5
                if amplitude < CIRCLES.beginning * FIRST * reach.amplitude:
                    raise ValueError(
                        "no circle was found beside the point; the normal form may not hold there"
                    )
                continue
            factor = 1.0 + 0.5 * (factor - 1.0)
            if factor < SLOWEST:
                return found, None
            amplitude = factor * abs(first_harmonic(found[-1], birth.frame))
            continue
        ended = _arrived(section, birth, reach, found, curve)
        if ended:
            return found, ended
        points = len(curve.points)
        if reach.to is None and amplitude >= reach.amplitude:
            return found, f"has half the size of the motion at {reach.name} = {curve.value:.8g}"
        amplitude *= factor
        factor = min(GROWTH, 1.0 + 1.5 * (factor - 1.0))
        if reach.to is None:
            amplitude = min(amplitude, reach.amplitude)
    return found, _enough(reach, found)


def _onwards(section: Sections, birth: Birth, reach: Reach, found: list[Curve]) -> str:
    """Along the family, as far as circles are smooth; `found` grows."""
    step = LONGEST
    while len(found) < reach.count:
        before = birth.curve(0.0, len(found[-1].points)) if len(found) == 1 else found[-2]
        torn = False
        for part in TRIES:
            guess, condition = _next(before, found[-1], birth, part * step)
            curve = _smooth(section, guess, birth.frame, condition)
            if curve is not None and not _torn(section, curve, birth.frame):
                break
            torn = torn or curve is not None
        else:
            return _broken(section, birth, reach, found[-1], torn)
        ended = _arrived(section, birth, reach, found, curve)
        if ended:
            return ended
        if reach.to is None and abs(first_harmonic(curve, birth.frame)) >= reach.amplitude:
            return f"has half the size of the motion at {reach.name} = {curve.value:.8g}"
        step = min(LONGEST, 1.3 * part * step)
        if step < LEAST:
            return _broken(section, birth, reach, curve, curve.tail > CIRCLES.smooth)
    return _enough(reach, found)


def _broken(section: Sections, birth: Birth, reach: Reach, last: Curve, torn: bool) -> str:
    """Why circles end."""
    at = f"near {reach.name} = {last.value:.8g}"
    if abs(last.rotation) < LINGERS * abs(birth.rotation):
        return (
            f"ends {at}, where its turns take {abs(birth.rotation / last.rotation):.3g} times as long as at its birth: "
            "the circle comes close to another cycle, beside which the motion lingers"
        )
    n, q = min(
        ((round(last.rotation * q), q) for q in range(1, PERIODS + 1)),
        key=lambda ratio: abs(last.rotation * ratio[1] - ratio[0]) * ratio[1],
    )
    if n and abs(last.rotation * q - n) * q < LOCKED:
        return f"the circle breaks {at}: its rotation {last.rotation:.5g} comes close to {n}/{q}, at which motions lock"
    outside = last.points + OUTWARDS * (last.points - last.points.mean(axis=0))
    if not np.isfinite([section(last.value).step(x) for x in outside]).all():
        return (
            f"ends {at}: points a little outside of it are no states of the motion, or run away (where the section is taken, "
            "the motion is next to a wall)"
        )
    why = "it is no longer smooth" if torn else "it cannot be followed any further"
    return f"the circle breaks {at}: {why}"


def _enough(reach: Reach, found: list[Curve]) -> str:
    return f"stopped after {reach.count} circles at {reach.name} = {found[-1].value:.8g}"


def _arrived(section: Sections, birth: Birth, reach: Reach, found: list[Curve], curve: Curve) -> str | None:
    """Keeps a circle, or the one at the end of the way, which is said then."""
    if reach.to is not None and (curve.value - reach.to) * reach.side >= 0.0:
        last = solve(section, curve._replace(value=reach.to), birth.frame, at_value(reach.to))
        if last is not None:
            found.append(last)
        return f"reaches {reach.name} = {reach.to:.8g}"
    found.append(curve)
    return None


def _larger(found: list[Curve], birth: Birth, amplitude: float, count: int) -> Curve:
    """The next circle from the last two: harmonics are linear in the amplitude, rotation and parameter in its square."""
    if not found:
        return birth.curve(amplitude, count)
    last = found[-1].finer(count)
    r = abs(first_harmonic(last, birth.frame))
    if len(found) == 1:
        before = birth.curve(0.0, count)
        share, bend = amplitude / r - 1.0, (amplitude / r) ** 2 - 1.0
    else:
        before = found[-2].finer(count)
        r0 = abs(first_harmonic(before, birth.frame))
        share, bend = (amplitude - r) / (r - r0), (amplitude**2 - r**2) / (r**2 - r0**2)
    return Curve(
        last.points + share * (last.points - before.points),
        last.rotation + bend * (last.rotation - before.rotation),
        last.value + bend * (last.value - before.value),
    )


def _next(before: Curve, last: Curve, birth: Birth, step: float) -> tuple[Curve, Condition]:
    """A guess in the direction of the last change, and the plane across it in which the circle is looked for."""
    here, there = (
        np.array([first_harmonic(curve, birth.frame).real, curve.rotation, curve.value])
        for curve in (last, before)
    )
    sizes = np.abs(here - (0.0, 0.0, birth.p))
    moved = (here - there) / sizes
    share = step / float(np.linalg.norm(moved))
    guess = Curve(
        last.points + share * (last.points - before.finer(len(last.points)).points),
        last.rotation + share * (last.rotation - before.rotation),
        last.value + share * (last.value - before.value),
    )
    normal = moved / np.linalg.norm(moved) / sizes
    target = float(normal @ here) + step
    return guess, Condition((float(normal[0]), float(normal[1]), float(normal[2])), target)


def _smooth(section: Sections, guess: Curve, frame: Frame, condition: Condition) -> Curve | None:
    """The circle through as many points as it needs."""
    curve: Curve | None = guess
    before: Curve | None = None
    while curve is not None:
        curve = solve(section, curve, frame, condition)
        if (
            before is not None
            and curve is not None
            and LESS * before.tail < curve.tail
            and before.tail < CIRCLES.torn
        ):
            return before
        if curve is None or curve.tail < CIRCLES.smooth or len(curve.points) >= MOST:
            return curve
        before = curve
        curve = curve.finer(min(MOST, 2 * len(curve.points) - 1))
    return None


def _torn(section: Sections, curve: Curve, frame: Frame) -> bool:
    """Whether what was found at so many points is no smooth closed curve."""
    if curve.tail > CIRCLES.torn:
        return True
    return not between(section(curve.value), curve) < CIRCLES.apart * abs(first_harmonic(curve, frame))
