"""What stands where in the data and work arrays of the kernels of a locus, and the conditions that it may follow."""

# of problems in Python alone: PERIOD, one of the unknowns, the period, has a given value; GROWTH, the only multiplier is 1
FOLD, FLIP, MARGIN, PAIR, BRANCH, PERIOD, GROWTH = range(7)

# entries of `data`
FIRST, SECOND, CALLS, KIND, WHICH, MULTIPLIERS, FLOW, UNIT = range(8)

# entries of `work`
(
    RESIDUAL,
    BASE,
    TRIAL,
    BASE_F,
    BASE_Q,
    TRIAL_F,
    TRIAL_Q,
    POINT,
    COLUMNS,
    SOLUTIONS,
    DIRECTIONS,
    BORDERS,
    ROW,
    SHIFTED,
    SCALES,
    VALUES,
    SLOPES,
    LINES,
    REFERENCE,
    SMALL,
    MASKED,
    ROWS,
    FROZEN,
    STEEP,
    STATE,
    FRAME,
    KEPT,
) = range(27)

ALONG, NULL, TESTED, LEFT, SPARE = range(5)  # rows of SOLUTIONS, the last one with another after it
B, C, FLIP_B, FLIP_C = range(4)  # rows of BORDERS
KNOWN, SIGN, ANGLE, SERVED = range(
    4
)  # entries of STATE; KNOWN: -1 nothing, 0 directions, 1 their slopes, too
APART = 4.5  # decades that a cycle may be further from an equilibrium than a homoclinic end of a branch is: 3 % of its size
LONGEST = 4  # points that borders serve
TURNED = 1.02  # length of the null vector, as long as c at first, at which they do not any more
