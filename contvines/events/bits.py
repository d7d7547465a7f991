"""What a segment between two points of a branch may hold, as bits, and the kinds of spectra that tell."""

FOLD, SINGULAR, MULTIPLIER, BORDER, MEETING, SHALLOW, DAMPED, HUMP = 1, 2, 4, 8, 16, 32, 64, 128

NONE, MAP, FLOW, REAL = 0, 1, 2, 3
KINDS = {"none": NONE, "map": MAP, "flow": FLOW, "real": REAL}

APART = 1e-6  # parts that a symmetry changes below this are zero
