"""Special points: their kinds, how they are detected, located, checked, classified, and the branches that leave them.

The steps, in order, for each chunk of points of a branch:

1. `scan` computes lengths, counts of multipliers and margins in one pass.
2. `evidence` turns these into signs and distances; `detect` selects the segments that may contain special points.
3. `segment_search` searches one segment for all `kinds`; `locate` solves for the zeros of their test functions, `first_border` for borders.
4. `consistency` compares the ends of the segment with the points found; if they disagree the segment is halved.
5. `switching` computes the first points of the branches that leave a point; `normal_forms` classifies it.

Terms:

segment
    Part of a branch between two neighbouring points; positions on it run from 0 to 1.
row
    Numbers of a point: its multipliers as (re, im) pairs, then its margins.
sign
    Sign of the bordered determinant det [[F_u, F_p], [tangent]].
outside, past
    Of multipliers: outside the unit circle; for eigenvalues right of the imaginary axis. Past +1, past -1: real ones outside.
meeting
    Point at which a branch returns to the fixed space of a symmetry, and ends.
leap
    A step that has jumped to another branch; it is traced again with shorter steps.
landing
    A step that ends next to a meeting; it is repeated with another length.
upright branch
    A branch along which the parameter changes by no more than rounding.
"""
