"""Borders: where a motion stops being possible, and the motion that takes its place.

`crossing` finds the branches on the other side, `rewriting` says how the word changes, `neighbours` solves for the orbit next to
the border, with what vanishes there held at a size, `rounds` knows what changes in some rounds only, `distance` compares motions whatever their
words, `dead_ends` says why nothing was found.
"""
