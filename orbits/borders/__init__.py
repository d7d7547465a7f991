"""Borders: where a motion stops being possible, and the motion that takes its place.

`crossing` finds the branches on the other side, `rewriting` says how the word changes, `growing` solves for the orbit next to
the border, `resting` knows the border of the stuck absorber, `motion` compares motions whatever their words, `reading` keeps the
first event of a word where it was.
"""
