"""Pseudo-arclength continuation of one branch: one algorithm, in the native core or in Python.

`trace` generates chunks of points from the loop (`loop` in Python, `native` in the native core), which predicts a point, corrects it (`corrector`) and
judges the step by a rule (`settings`); `ends` detects closed and escaping branches. `engine` holds problem, metric and work arrays, and solves single
points; `layout` has the data that all of them share; `starts` checks the start.
"""
