"""Load machine files of the examples, each one once."""

from functools import cache
from pathlib import Path

from orbits.machines.page.loading import load_page

PAGES = Path(__file__).resolve().parents[2] / "examples" / "machines"


@cache
def page(name):
    return load_page(PAGES / f"{name}.py", "machine")
