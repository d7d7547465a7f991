"""Borders: where a motion stops being possible, and the motion that takes its place.

`crossing` finds the branches on the other side, `rewriting` says how the word changes, `neighbours` solves for the orbit next to
the border, with what vanishes there `holding` a size, `rounds` knows what changes in some rounds only, `sticking` the border of the stuck absorber,
`distance` compares motions whatever their words, `alignment` keeps the first event of a word where it was, `settling` simulates on,
`dead_ends` says why nothing was found.
"""
