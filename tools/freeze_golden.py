"""Write the golden files of some studies, or of all that have none yet: `python -m tools.freeze_golden [NAME ...]`.

A golden file changes only where an independent proof says that it was wrong; the reason stands in `changes.md`.
"""

from __future__ import annotations

import json
import sys
import time

from tests.golden.studies import file_of, studies


def main(names: list[str]) -> None:
    known = studies()
    for name in names or [name for name in known if not file_of(name).exists()]:
        began = time.process_time()
        text = json.dumps(known[name](), indent=1)
        file_of(name).write_text(text + "\n")
        print(f"{name}: {time.process_time() - began:.1f} s", flush=True)


if __name__ == "__main__":
    main(sys.argv[1:])
