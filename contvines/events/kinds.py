"""The kinds of special points: one table, from which labels, marks in pictures, tables and rules are taken.

A new kind is a line here, and something that finds it: a test function beside this file, or a margin whose problem names
the kind (``margin_kind``).
"""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Kind:
    """A kind of special point.

    Attributes
    ----------
    name : str
        As in JSON and in :meth:`contvines.Graph.of_kind`.
    label : str
        What labels begin with, as the field writes it: LP1, LP2 ...
    text : str
        For people.
    marker : str
        In pictures, as matplotlib knows it.
    filled : bool
    border : bool
        A margin vanishes there, and a branch ends.
    """

    name: str
    label: str
    text: str
    marker: str = "o"
    filled: bool = False
    border: bool = False


_ALONG = (
    Kind("fold", "LP", "fold", "s", True),
    Kind("symmetry-breaking", "SB", "symmetry breaking", "D"),
    Kind("period-doubling", "PD", "period doubling", "^"),
    Kind("neimark-sacker", "NS", "Neimark-Sacker", "p"),
    Kind("hopf", "HB", "Hopf", "h"),
    Kind("branch-point", "BP", "branch point"),
    # borders that are met at once take the first of these names
    Kind("stick", "ST", "turn to stick", "<", True, True),
    Kind("velocity-graze", "VG", "velocity graze", "v", True, True),
    Kind("wall-graze", "WG", "wall graze", ">", True, True),
    Kind("chatter", "CH", "vanishing event", "X", True, True),
    Kind("switch-graze", "SG", "switch graze", "d", True, True),
    Kind("corner", "CO", "two events at once", "P", True, True),
    Kind("switch", "SW", "switch", "d", False, True),
    Kind("homoclinic", "HC", "homoclinic orbit", "H", True, True),
    Kind("user", "US", "user function", "*", True),
    Kind("end", "EP", "end of the interval", "|"),
)

_CROSSINGS = (
    Kind("cusp", "CP", "cusp"),
    Kind("generalized-period-doubling", "GPD", "generalized period doubling"),
    Kind("degenerate-symmetry-breaking", "GSB", "degenerate symmetry breaking"),
    Kind("chenciner", "CH", "Chenciner"),
    Kind("resonance-1-1", "R1", "resonance 1:1"),
    Kind("resonance-1-2", "R2", "resonance 1:2"),
    Kind("resonance-1-3", "R3", "resonance 1:3"),
    Kind("resonance-1-4", "R4", "resonance 1:4"),
    Kind("fold-flip", "LPPD", "fold and period doubling"),
    Kind("fold-symmetry-breaking", "LPSB", "fold and symmetry breaking"),
    Kind("fold-neimark-sacker", "LPNS", "fold and Neimark-Sacker"),
    Kind("flip-neimark-sacker", "PDNS", "period doubling and Neimark-Sacker"),
    Kind("symmetry-breaking-neimark-sacker", "SBNS", "symmetry breaking and Neimark-Sacker"),
    Kind("double-neimark-sacker", "NSNS", "two Neimark-Sacker"),
    Kind("bogdanov-takens", "BT", "Bogdanov-Takens"),
    Kind("generalized-hopf", "GH", "generalized Hopf"),
    Kind("zero-hopf", "ZH", "zero-Hopf"),
    Kind("double-hopf", "HH", "double Hopf"),
    Kind("border-fold", "BLP", "border and fold"),
    Kind("border-flip", "BPD", "border and period doubling"),
    Kind("border-symmetry-breaking", "BSB", "border and symmetry breaking"),
    Kind("border-neimark-sacker", "BNS", "border and Neimark-Sacker"),
    Kind("double-border", "BB", "two borders"),
    Kind("degenerate-border", "DB", "degenerate border"),
)

#: of codimension one: found along a branch
KINDS: dict[str, Kind] = {kind.name: kind for kind in _ALONG}
#: of codimension two: found along a locus
CODIMENSION_TWO: dict[str, Kind] = {kind.name: kind for kind in _CROSSINGS}
PREFIXES: dict[str, str] = {kind.name: kind.label for kind in _ALONG}
BORDERS: tuple[str, ...] = tuple(kind.name for kind in _ALONG if kind.border)


def kind_of(name: str) -> Kind:
    """The kind of this name; a problem's own border kinds that are not in the table are borders drawn plainly."""
    return KINDS.get(name) or CODIMENSION_TWO.get(name) or Kind(name, "US", name.replace("-", " "))
