"""The package structure in order: no two files that need one another."""

import ast
from functools import cache
from importlib.util import resolve_name
from pathlib import Path

import networkx as nx

ROOT = Path(__file__).parents[1]
PACKAGES = ("contvines", "orbits")
HELD = {
    "contvines.branches",
    "contvines.branches.special_point",
    "contvines.circles.circle",
    "contvines.coexistence.basins",
    "contvines.coexistence.erosion",
    "contvines.flows.orbit",
    "contvines.graph",
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


def of_methods(tree):
    """All parts of the methods of a file's classes."""
    for thing in tree.body:
        if isinstance(thing, ast.ClassDef):
            for method in thing.body:
                if isinstance(method, ast.FunctionDef):
                    yield from ast.walk(method)


def imports(path, known):
    """Files of both packages that a file imports, at its top, inside functions (methods of `HELD` aside), or for types only."""
    own, tree = module_of(path), ast.parse(path.read_bytes())
    package = own if path.name == "__init__.py" else own.rpartition(".")[0]
    comfort = set(of_methods(tree)) if own in HELD else set()
    for node in set(ast.walk(tree)) - comfort:
        wanted = []
        if isinstance(node, ast.Import):
            wanted = [alias.name for alias in node.names]
        elif isinstance(node, ast.ImportFrom):
            base = resolve_name("." * node.level + (node.module or ""), package)
            names = [f"{base}.{alias.name}" for alias in node.names]
            wanted = [name if name in known else base for name in names]
        yield from (name for name in wanted if name in known and name != own)


@cache
def needs():
    """Pairs of files, of which the first needs the second."""
    files = {module_of(path): path for package in PACKAGES for path in (ROOT / package).rglob("*.py")}
    return {(name, other) for name, path in files.items() for other in imports(path, files)}


def in_circles(pairs):
    return [circle for circle in nx.strongly_connected_components(nx.DiGraph(pairs)) if len(circle) > 1]


def test_no_two_files_need_one_another():
    assert len(needs()) > 1000  # they were read
    assert not in_circles(needs())


def test_no_two_rooms_need_one_another():
    """Folder by folder: what lies in it, folders taken as a whole, has an order from bottom to top."""
    for folder in {name.rpartition(".")[0] for pair in needs() for name in pair} - {""}:
        inside = [pair for pair in needs() if all(name.startswith(f"{folder}.") for name in pair)]
        depth = folder.count(".") + 2
        assert not in_circles([[".".join(name.split(".")[:depth]) for name in pair] for pair in inside])
