"""`python -m tests.benchmarks` is `python -m tools.benchmarks`."""

from tools.benchmarks.run import main

main()
