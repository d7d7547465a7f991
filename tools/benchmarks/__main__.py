"""`python -m tools.benchmarks`."""

from .run import main

main()
