"""Write table.json with the special points of every demo with cycles, by the package and by the independent solver (`witness.py`).

python -m tools.flow_demos.make_table [NAME...]
"""

from __future__ import annotations

import json
import signal
import sys
from pathlib import Path
from typing import Any

import numpy as np

from . import witness
from .listed import DEMOS, CycleDemo

TABLE = Path(__file__).with_name("table.json")
PATIENCE = 120.0  # most seconds of processor time for the independent solution of a point


def points_of(graph: Any) -> list[Any]:
    """Return the special points of cycles and the Hopf points, without ends of the interval.

    Folds that cannot be separated from a period doubling in double precision are left out, too (`pen` has them 1.5e-15 apart).
    """
    found, doublings = [], graph.of_kind("period-doubling")
    for point in graph.special.values():
        rest = graph.branches[point.branch].description["word"] == "equilibrium"
        blurred = point.kind == "fold" and any(
            abs(point.value - other.value) <= point.location_error + other.location_error
            for other in doublings
        )
        if point.kind != "end" and not blurred and (not rest or point.kind == "hopf"):
            found.append(point)
    return sorted(found, key=lambda point: (point.kind, point.value))


def shooting_of(demo: CycleDemo, point: Any) -> witness.Shooting:
    """Return the equations of the independent solver, with states of the package's cycle as guess."""
    orbit, turn = point.orbit, None
    if point.kind == "symmetry-breaking":
        mirror = np.asarray(demo.mirror, dtype=float)
        later = mirror @ orbit(0.5 * orbit.period)
        if np.abs(later - orbit(0.0)).max() < 1e-3 * np.ptp(orbit.states, axis=0).max():
            turn = mirror
    share = 1.0 if turn is None else 0.5
    mesh = orbit.times[orbit.times < share * orbit.period] / (share * orbit.period)
    rounds = point.problem.rounds if demo.period else 1
    unit = np.ptp(orbit.states, axis=0)
    for parts in witness.PARTS:
        cuts = np.append(mesh[np.arange(parts) * len(mesh) // parts], 1.0)
        states = orbit(cuts[:-1] * share * orbit.period)
        found = witness.Shooting(
            demo.equations, demo.period, cuts, states, unit, orbit.period, point.value, rounds, turn
        )
        if found.growth() < witness.GROWTH:
            break
    if point.kind == "symmetry-breaking" and turn is None:  # exclude the trivial multiplier, which is also +1
        signs, directions = np.linalg.eigh(np.asarray(demo.mirror, dtype=float))
        found.odd = directions[:, signs < 0.0]
    return found


def solved(demo: CycleDemo, point: Any) -> float:
    """Return the independent value of a special point."""
    p = float(point.value)
    exact = [value for kind, value in demo.exact if kind == point.kind]
    if exact:
        return exact[0]
    if point.kind == "hopf":
        u = np.asarray(point.u, dtype=float) if len(point.u) == len(demo.u) else point.orbit.states[0]
        return witness.hopf(demo.rates, u, p)[1]
    if point.kind == "homoclinic":
        orbit = point.orbit
        states = orbit(np.linspace(0.0, orbit.period, 4001)[:-1])
        speed = np.linalg.norm(np.array([demo.rates(x, p) for x in states]) / np.ptp(states, axis=0), axis=1)
        states = np.roll(states, -int(np.argmin(speed)), axis=0)
        if "saddle-node" in point.note:
            return witness.fold_of_equilibria(demo.rates, states[0], p)[1]
        width = max(3.0 * point.location_error, 1e-7 * (demo.within[1] - demo.within[0]))
        return witness.Homoclinic(demo.rates, states).solve(p, width)
    shooting = shooting_of(demo, point)
    multiplier: complex = -1.0
    if point.kind == "neimark-sacker":
        values = point.orbit.multipliers
        pairs = values[values.imag > 1e-9]
        multiplier = complex(pairs[int(np.argmin(np.abs(np.abs(pairs) - 1.0)))])
    elif point.kind == "symmetry-breaking" and shooting.turn is None:
        multiplier = 1.0
    return float(witness.solve(point.kind, shooting, multiplier)[-1])


def too_long(*_: Any) -> None:
    """Handle the time limit: end a solution that takes too long."""
    raise ValueError(f"not done in {PATIENCE:g} s")


def rows_of(demo: CycleDemo, ours: bool) -> list[dict[str, Any]]:
    """Return a row for each special point."""
    rows = []
    for point in points_of(demo.graph()):
        signal.setitimer(signal.ITIMER_VIRTUAL, PATIENCE)
        try:
            value = None if ours else solved(demo, point)
        except (ValueError, ArithmeticError, np.linalg.LinAlgError) as failure:
            print(demo.name, point.kind, point.value, "not solved:", failure, file=sys.stderr)
            value = None
        finally:
            signal.setitimer(signal.ITIMER_VIRTUAL, 0.0)
        period = None if point.kind == "hopf" else float(point.orbit.period)
        rows.append(
            {
                "kind": point.kind,
                "value": value,
                "ours": float(point.value),
                "stated": float(point.location_error),
                "period": period,
            }
        )
        away = abs((value or 0.0) - point.value) / (demo.within[1] - demo.within[0])
        print(
            f"{demo.name}: {point.kind} {value!r} ours {point.value!r} away {away:.1e} stated {point.location_error:.1e}",
            flush=True,
        )
    return rows


def main(names: list[str]) -> None:
    """Write the whole table, or the rows of some demos."""
    signal.signal(signal.SIGVTALRM, too_long)
    ours, names = "--ours" in names, [name for name in names if name != "--ours"]
    for demo in DEMOS:
        if names and demo.name not in names:
            continue
        rows = rows_of(demo, ours)
        table = json.loads(TABLE.read_text(encoding="utf-8")) if TABLE.exists() else {}
        table[demo.name] = rows
        table = {d.name: table[d.name] for d in DEMOS if d.name in table}
        TABLE.write_text(
            json.dumps(table).replace("], ", "],\n").replace("}, {", "},\n {") + "\n", encoding="utf-8"
        )


if __name__ == "__main__":
    main(sys.argv[1:])
