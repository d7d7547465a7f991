"""Write golden files of the named studies, or of all that have none: `python -m tools.freeze_golden [NAME ...]`.

Change a golden file only if an independent proof shows that it was wrong, and write the reason into `changes.md`.
"""

from __future__ import annotations

import json
import sys
import time

from tests.golden.studies import file_of, studies


def main(names: list[str]) -> None:
    """Write the golden files."""
    known = studies()
    for name in names or [name for name in known if not file_of(name).exists()]:
        began = time.process_time()
        text = json.dumps(known[name](), indent=1)
        file_of(name).write_text(text + "\n")
        print(f"{name}: {time.process_time() - began:.1f} s", flush=True)


if __name__ == "__main__":
    main(sys.argv[1:])
