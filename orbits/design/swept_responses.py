"""Responses of a machine by simulation alone: sweeps up and down, and from drawn starts that lead elsewhere, nearer to the largest response.

For machines whose flights are integrated, where a diagram takes as long as hundreds of these simulations.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

from orbits.attractors.sweeping import SweepRow, sweep
from orbits.flows.catalogue import flow_of
from orbits.flows.protocol import SimulationError
from orbits.population.population import Population
from orbits.settings import DESIGNING

if TYPE_CHECKING:
    from orbits.machines.varying import Varying
    from orbits.simulation.runs import Start

DRAWN = 3  # starts at the first, the middle and the last value
USUAL, LONG = (
    200,
    800,
)  # forcing periods that are left out, and of a motion without a period that may be a transient
ENDS = 0.01  # relative fall of the response by which a transient is known
CLIMBED = 24  # values to either side of the largest response


def swept_responses(
    model: Varying, over: str, values: Sequence[float], parameters: Mapping[str, float]
) -> list[tuple[float, float]]:
    """Motions that simulations settle on: at each value those of a sweep up and one down, and those that drawn starts add, each followed both ways
    to where another one takes over; the largest response is followed to its top, and for longer where it has no period.

    Parameters
    ----------
    model : Model or Machine
    over : str
    values : sequence of float
        Ascending.
    parameters : mapping
        Those that are no fields of the machine.

    Returns
    -------
    list of (float, float)
        Value and response (the measure that is shown); the latter may be no number.

    Raises
    ------
    SimulationError
        If a motion runs away.
    """
    seen = _Seen(model, over, values, parameters)
    seen.run(range(len(values)), None, until_known=False)
    seen.run(range(len(values))[::-1], None, until_known=False)
    population = Population(model, over, parameters)
    for k in sorted({0, len(values) // 2, len(values) - 1}):
        for start in population.starts(DRAWN, 0, values[k]):
            try:
                row = seen.at(values[k], start)
            except SimulationError:  # it runs away, or begins inside a wall
                continue
            if not seen.knows(row):
                seen.rows.append(row)
                for run in (range(k + 1, len(values)), range(k)[::-1]):
                    seen.run(run, row.detail.state, until_known=True)
    seen.confirm()
    seen.climb()
    seen.confirm()
    return [(row.value, seen.response(row)) for row in seen.rows]


class _Seen:
    """Motions that were met."""

    def __init__(
        self, model: Varying, over: str, values: Sequence[float], parameters: Mapping[str, float]
    ) -> None:
        self.model, self.over, self.values = model, over, values
        self.numbers: dict[str, Any] = {name: x for name, x in parameters.items() if name != over}
        self.measure = flow_of(model).default_measure(model)
        self.rows: list[SweepRow] = []

    def at(self, value: float, start: Start, transient: float = USUAL) -> SweepRow:
        """What a state leads to."""
        ways = {"transient": transient, "exponents": False}
        (row,) = sweep(self.model, self.over, [value], start=start, **ways, **self.numbers)
        return row

    def response(self, row: SweepRow) -> float:
        return float(row.measures.get(self.measure, math.nan))

    def knows(self, row: SweepRow) -> bool:
        """Whether a motion was met at this value already; of those without a period there is one."""
        here, own = [other for other in self.rows if other.value == row.value], self.response(row)
        return any(
            abs(self.response(other) - own) <= DESIGNING.agreement * abs(own)
            if row.periods and other.periods
            else row.periods == other.periods
            for other in here
        )

    def run(self, places: Sequence[int], start: Start, until_known: bool) -> None:
        """Follow a motion along some of the values; to one that is known, if asked."""
        for k in places:
            row = self.at(self.values[k], start)
            if until_known and self.knows(row):
                return
            self.rows.append(row)
            start = row.detail.state

    def confirm(self) -> None:
        """Follow the largest response for longer as long as it is that of a motion without a period: it may be a transient that is slow to end."""
        while True:
            top = max(self.rows, key=lambda row: _number(self.response(row)))
            if top.periods:
                return
            longer = self.at(top.value, top.detail.state, LONG)
            if not self.response(longer) < (1.0 - ENDS) * self.response(top):
                return
            self.rows[:] = [longer if row is top else row for row in self.rows]

    def climb(self) -> None:
        """From the largest response on either way while it grows, in steps that are halved where it does not: a motion that steps of the values lose goes on
        in smaller ones to where it ends."""
        span, spacing = self.values[-1] - self.values[0], self.values[1] - self.values[0]
        top = max(self.rows, key=lambda row: _number(self.response(row)))
        for side in (-1, 1):
            here, step = top, 0.5 * spacing
            for _ in range(CLIMBED):
                value = min(max(here.value + side * step, self.values[0]), self.values[-1])
                if step < DESIGNING.narrow * span or value == here.value:
                    break
                row = self.at(value, here.detail.state)
                self.rows.append(row)
                if _number(self.response(row)) > _number(self.response(here)):
                    here = row
                else:
                    step *= 0.5


def _number(response: float) -> float:
    return response if math.isfinite(response) else -math.inf
