"""``python -m tools.fuzz KIND COUNT SALT [--finer] [--first SEED]``: print each finding, then totals."""

from __future__ import annotations

import argparse
import time

from tools.fuzz.drawing import KINDS
from tools.fuzz.searching import search
from tools.fuzz.tally import Tally


def main() -> int:
    """Check all machines; return 1 if there are findings."""
    parser = argparse.ArgumentParser(prog="python -m tools.fuzz", description="Search for false results.")
    parser.add_argument("kind", choices=KINDS)
    parser.add_argument("count", type=int, help="machines")
    parser.add_argument("salt", type=int, help="another salt draws other machines")
    parser.add_argument(
        "--finer", action="store_true", help="diagrams once more, with finer steps and in a wider interval"
    )
    parser.add_argument("--first", type=int, default=0, metavar="SEED")
    asked = parser.parse_args()
    total, began = Tally(), time.process_time()
    for seed in range(asked.first, asked.first + asked.count):
        done = search(asked.kind, asked.salt, seed, asked.finer)
        for finding in done.findings:
            print(finding, flush=True)
        total.add(done)
    print(
        f"\n{total.table()}\n\n{len(total.findings)} findings, {time.process_time() - began:.0f} s of processor time"
    )
    return 1 if total.findings else 0


if __name__ == "__main__":
    raise SystemExit(main())
