"""The name under which files of version 0.1 know problems of the stuck absorber."""

from orbits.cycles.stuck_problem import rebuild as rebuild
