"""Compare all special orbits of the gallery's machine files with an independent integrator.

`python -m tools.pages.gallery [NAME ...]` computes the diagrams of `examples/machines/draw.py` and prints, for each, the
largest difference between nodes of special orbits and DOP853 (1e-12, with events) from node to node; infinite if a different event happens.
"""

import importlib.util
import sys
import time

from orbits import Orbit
from tools.pages.independent import deviation
from tools.pages.pages import PAGES


def gallery():
    """Import the module that draws the gallery."""
    spec = importlib.util.spec_from_file_location("gallery_of_pages", PAGES / "draw.py")
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def deviations(graph) -> dict[str, float]:
    """Return special point -> difference between its orbit and the independent integration."""
    found = {}
    for label, point in graph.special.items():
        problem = graph.branches[point.branch].problem
        if point.kind != "end" and problem.dimension == len(point.u):
            orbit = problem.orbit(point.u, point.value)
            if not isinstance(orbit, Orbit):  # a cycle of a smooth flow, which `tools.flow_demos` checks
                continue
            found[label] = deviation(orbit, orbit.model.equations.formulas_of_motion)
    return found


def main() -> None:
    """Print the largest difference for every machine file."""
    module = gallery()
    for name in sys.argv[1:] or module.RUNS:
        began = time.process_time()
        _, graph = module.diagram(name)
        found = deviations(graph)
        worst = max(found, key=lambda label: found[label]) if found else ""
        text = f"largest {found[worst]:.1e} at {worst} ({graph.special[worst].kind})" if found else "none"
        print(f"{name}: {len(found)} special orbits, {text}; {time.process_time() - began:.0f} s", flush=True)
        for label, value in found.items():
            if not value < 1e-8:
                point = graph.special[label]
                word = graph.branches[point.branch].description["word"]
                print(f"  {label} {point.kind} at {point.value:.10g} on {word!r}: {value:.1e}", flush=True)


if __name__ == "__main__":
    main()
