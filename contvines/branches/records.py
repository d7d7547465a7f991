"""Located events in a journal."""

from __future__ import annotations

from typing import Any

import numpy as np

from ..bifurcation.kinds import RENAMED
from ..bifurcation.located import Located, Role
from ..continuation.engine import Engine, Solved


def pack(events: list[Located], engine: Engine) -> dict[str, Any]:
    """Located events as arrays and JSON scalars, for a journal."""
    n, m = engine.n, engine.row_size
    points = [e.point for e in events]
    return {
        "kind": [e.kind for e in events],
        "role": [e.role.value for e in events],
        "name": [e.name for e in events],
        "index": [int(e.index) for e in events],
        "numbers": np.array(
            [
                [
                    e.position,
                    e.error,
                    *e.bracket,
                    e.point.p,
                    e.point.sign,
                    e.point.residual,
                    e.point.correction,
                ]
                for e in events
            ]
        ).reshape(len(events), 8),
        "u": np.array([p.u for p in points]).reshape(len(events), n),
        "tangent": np.array([p.tangent for p in points]).reshape(len(events), n + 1),
        "row": np.array([p.row for p in points]).reshape(len(events), m),
    }


def unpack(record: dict[str, Any]) -> list[Located]:
    """Located events from a journal."""
    events = []
    for i, name in enumerate(record["kind"]):
        kind = RENAMED.get(str(name), str(name))
        position, error, low, high, p, sign, residual, correction = (float(x) for x in record["numbers"][i])
        point = Solved(
            np.array(record["u"][i]),
            p,
            np.array(record["tangent"][i]),
            np.array(record["row"][i]),
            sign,
            residual,
            correction,
        )
        events.append(
            Located(
                position,
                kind,
                int(record["index"][i]),
                point,
                (low, high),
                error,
                Role(record["role"][i]),
                record["name"][i],
            )
        )
    return events
