"""The conditions that a locus may follow, and what stands where in the arrays of its kernels."""

# in Python alone: PERIOD, one of the unknowns, the period, has a given value; GROWTH, the only multiplier is 1; OWN, the condition of a user's kind
FOLD, FLIP, MARGIN, PAIR, BRANCH, PERIOD, GROWTH, OWN = range(8)

ALONG, NULL, TESTED, LEFT, SPARE = range(5)  # rows of `solutions`, the last one with another after it
B, C, FLIP_B, FLIP_C = range(4)  # rows of `borders`
KNOWN, SIGN, ANGLE, SERVED = range(
    4
)  # entries of `state`; KNOWN: -1 nothing, 0 directions, 1 their slopes, too
APART = 0.03  # of its size: how far from an equilibrium a cycle may stay that stands for a homoclinic orbit
LONGEST = 4  # points that borders serve
TURNED = 1.02  # length of the null vector, as long as c at first, at which they do not any more
