"""Certificates as data: what `orbits.proofs.checker` needs, and nothing else; numbers are decimal text.

A certificate is a chain of boxes, orbit, tile, orbit ... tile, orbit; each unknown of a box is [middle, slope, radius].
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from decimal import Decimal
from platform import python_version
from typing import Any

from orbits.proofs.balls import library
from orbits.proofs.enclosing import Box
from orbits.proofs.equations import Motif
from orbits.proofs.flights import parameter_names
from orbits.proofs.special import Vanishing
from orbits.proofs.tiles import Tile
from orbits.proofs.varying import Varying

FORMAT = "contvines certificate 3"
Entry = dict[str, Any]


def plain(text: str) -> str:
    """A decimal as certificates write it."""
    number = Decimal(text)
    return str(number).lower() if number else "0"


def orbit_box(motif: Motif, box: Box, value: str = "1", basis: Sequence[Sequence[str]] = ()) -> Entry:
    """A proved orbit, where the parameter (if one varies) has this value."""
    nodes = [[[mid, "0", rad] for mid, rad in node[: motif.node]] for node in box.nodes]
    return _entry(motif, nodes, [plain(value), "0", "0"], "0", basis)


def tile_box(motif: Motif, tile: Tile) -> Entry:
    """A tile."""
    return _entry(motif, tile.nodes, tile.parameter, tile.half, tile.basis)


def resting_box(motif: Motif, value: str = "1", half: str = "0") -> Entry:
    """The stuck absorber at a value of the parameter, or on an interval of it."""
    return _entry(motif, [], [plain(value), "0" if half == "0" else "1", "0"], half, ())


def _entry(
    motif: Motif,
    nodes: Sequence[Sequence[Sequence[str]]],
    parameter: list[str],
    half: str,
    basis: Sequence[Sequence[str]],
) -> Entry:
    n = motif.node
    unit = [["1" if i == j else "0" for j in range(n)] for i in range(n)]
    return {
        "nodes": nodes or [[["0", "0", "0"]] * n],
        "parameter": parameter,
        "half_width": half,
        "basis": [list(row) for row in basis] or unit,
        "kind": None,
        "conditions": [],
    }


def conditions(motif: Motif, vanishing: Vanishing) -> list[list[str | int]]:
    """The inequality that a border is about, as the checker calls it."""
    if vanishing.name in ("flight", "turn", "slip"):
        return [["flight", vanishing.event, motif.modes[vanishing.event]]]
    return [["wall" if vanishing.name == "wall" else "flight", vanishing.event, vanishing.side]]


def certificate(
    motif: Motif,
    parameters: Mapping[str, Any],
    varying: Varying | None,
    boxes: Sequence[Entry],
    real: bool | None,
    stable: bool | None,
    bits: int,
) -> Entry:
    """The whole certificate as JSON."""
    return {
        "format": FORMAT,
        "parameters": numbers(motif.machine, parameters, varying),
        "events": "".join(motif.events) or "o",
        "modes": list(motif.modes) or [0],
        "periods": motif.periods,
        "half": motif.half,
        "frictionless": motif.frictionless,
        "boxes": list(boxes),
        "claims": {"existence": True, "real": real, "stable": stable},
        "bits": bits,
        "versions": {"python-flint": library().__version__, "python": python_version()},
    }


def numbers(machine: str, parameters: Mapping[str, Any], varying: Varying | None) -> dict[str, list[str]]:
    """The machine's numbers: middle, radius, and the power of the parameter that multiplies them."""
    moved = varying.numbers if varying else {}
    given: dict[str, list[str]] = {}
    for name in parameter_names(machine):
        if name in moved:
            factor, exponent = moved[name]
            given[name] = [plain(factor), "0", plain(str(Decimal(exponent)))]
        else:
            value = parameters[name] if name != "slope" else parameters.get(name, "0")
            middle, radius = (value, "0") if isinstance(value, str) else value
            given[name] = [plain(middle), plain(radius), "0"]
    return given
