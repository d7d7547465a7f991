"""Kinds of points of codimension two, found along a locus."""

from __future__ import annotations

from ..kind import Kind

_ROWS = (
    ("cusp", "CP", "cusp"),
    ("generalized-period-doubling", "GPD", "generalized period doubling"),
    ("degenerate-symmetry-breaking", "GSB", "degenerate symmetry breaking"),
    ("chenciner", "CH", "Chenciner"),
    ("resonance-1-1", "R1", "resonance 1:1"),
    ("resonance-1-2", "R2", "resonance 1:2"),
    ("resonance-1-3", "R3", "resonance 1:3"),
    ("resonance-1-4", "R4", "resonance 1:4"),
    ("fold-flip", "LPPD", "fold and period doubling"),
    ("fold-symmetry-breaking", "LPSB", "fold and symmetry breaking"),
    ("fold-neimark-sacker", "LPNS", "fold and Neimark-Sacker"),
    ("flip-neimark-sacker", "PDNS", "period doubling and Neimark-Sacker"),
    ("symmetry-breaking-neimark-sacker", "SBNS", "symmetry breaking and Neimark-Sacker"),
    ("double-neimark-sacker", "NSNS", "two Neimark-Sacker"),
    ("bogdanov-takens", "BT", "Bogdanov-Takens"),
    ("generalized-hopf", "GH", "generalized Hopf"),
    ("zero-hopf", "ZH", "zero-Hopf"),
    ("double-hopf", "HH", "double Hopf"),
    ("border-fold", "BLP", "border and fold"),
    ("border-flip", "BPD", "border and period doubling"),
    ("border-symmetry-breaking", "BSB", "border and symmetry breaking"),
    ("border-neimark-sacker", "BNS", "border and Neimark-Sacker"),
    ("double-border", "BB", "two borders"),
    ("degenerate-border", "DB", "degenerate border"),
)
#: one more margin vanishes there
_BORDERS = (
    "border-fold",
    "border-flip",
    "border-symmetry-breaking",
    "border-neimark-sacker",
    "double-border",
)
CODIMENSION_TWO: dict[str, Kind] = {
    name: Kind(name, label, text=text, marker="o", filled=False, border=name in _BORDERS)
    for name, label, text in _ROWS
}
