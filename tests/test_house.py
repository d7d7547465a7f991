"""The package structure in order: no two files that need one another."""

import ast
from functools import cache
from pathlib import Path

ROOT = Path(__file__).parents[1]
PACKAGES = ("contvines", "orbits")
HELD = {
    "contvines.branches.branch",
    "contvines.branches.special_point",
    "contvines.circles.circle",
    "contvines.coexistence.basins",
    "contvines.coexistence.erosion",
    "contvines.flows.orbit",
    "contvines.graph.graph",
    "contvines.loci.chart",
    "contvines.loci.locus",
    "contvines.problems.maps",
    "contvines.survey.results",
    "orbits.machines.absorber",
    "orbits.machines.coupled",
    "orbits.flows.page.smooth",
    "orbits.machines.page.machine",
    "orbits.machines.varying",
    "orbits.orbit",
    "orbits.problem",
}
"""Files of the classes that users hold. Their methods for comfort (``graph.plot()``) import what stands above, inside the method; nothing else does."""


def module_of(path):
    parts = path.relative_to(ROOT).with_suffix("").parts
    return ".".join(parts[:-1] if parts[-1] == "__init__" else parts)


@cache
def parsed(path):
    return ast.parse(path.read_text())


def of_methods(tree):
    """All parts of the methods of a file's classes."""
    for thing in tree.body:
        if isinstance(thing, ast.ClassDef):
            for method in thing.body:
                if isinstance(method, ast.FunctionDef):
                    yield from ast.walk(method)


def imports(path, known):
    """Files of both packages that a file imports, at its top, inside functions (methods of `HELD` aside), or for types only."""
    own = module_of(path)
    package = own if path.name == "__init__.py" else own.rpartition(".")[0]
    comfort = set(of_methods(parsed(path))) if own in HELD else set()
    for node in ast.walk(parsed(path)):
        if node in comfort:
            continue
        if isinstance(node, ast.Import):
            wanted = [alias.name for alias in node.names]
        elif isinstance(node, ast.ImportFrom):
            base = node.module or ""
            if node.level:
                parts = package.split(".")
                base = ".".join([*parts[: len(parts) - node.level + 1], *([base] if base else [])])
            names = [f"{base}.{alias.name}" for alias in node.names]
            wanted = [name if name in known else base for name in names]
        else:
            continue
        yield from (name for name in wanted if name in known and name != own)


def in_circles(needs):
    """Names in or above a circle, found by removing what needs nothing that is left, again and again."""
    needs = {name: set(wanted) for name, wanted in needs.items()}
    while free := [name for name, wanted in needs.items() if not wanted & needs.keys()]:
        for name in free:
            del needs[name]
    return sorted(needs)


@cache
def needs_of_files():
    paths = [path for package in PACKAGES for path in (ROOT / package).rglob("*.py")]
    known = {module_of(path) for path in paths}
    return {module_of(path): frozenset(imports(path, known)) for path in paths}


def test_no_two_files_need_one_another():
    needs = needs_of_files()
    assert sum(map(len, needs.values())) > 1000  # they were read
    assert not in_circles(needs)


def test_no_two_rooms_need_one_another():
    """Folder by folder: what lies in it, folders taken as a whole, has an order from bottom to top."""
    files = needs_of_files()
    folders = {name.rpartition(".")[0] for name in files} - {""}
    for folder in folders:
        depth = folder.count(".") + 2
        rooms: dict[str, set[str]] = {}
        for name, wanted in files.items():
            if name.startswith(f"{folder}."):
                room = ".".join(name.split(".")[:depth])
                there = {
                    ".".join(other.split(".")[:depth]) for other in wanted if other.startswith(f"{folder}.")
                }
                rooms.setdefault(room, set()).update(there - {room})
        assert not in_circles(rooms), folder
