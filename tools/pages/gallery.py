"""Every special orbit of the gallery's pages against an integrator that shares nothing with the engine.

`python -m tools.pages.gallery [NAME ...]` makes the diagrams of `examples/machines/draw.py` and prints, for each, the
largest difference between a special orbit's nodes and DOP853 at 1e-12 with events, from node to node. Infinite: something else happens.
"""

import importlib.util
import sys
import time

from orbits import Orbit
from tools.pages.independent import deviation
from tools.pages.pages import PAGES


def gallery():
    """The module that draws the gallery."""
    spec = importlib.util.spec_from_file_location("gallery_of_pages", PAGES / "draw.py")
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def deviations(graph) -> dict[str, float]:
    """Special point -> how far its orbit is from the independent integrator's."""
    found = {}
    for label, point in graph.special.items():
        problem = graph.branches[point.branch].problem
        if point.kind != "end" and problem.dimension == len(point.u):
            orbit = problem.orbit(point.u, point.value)
            if not isinstance(orbit, Orbit):  # a cycle of the smooth flow: judged by shooting elsewhere
                continue
            found[label] = deviation(orbit, orbit.model.equations.formulas_of_motion)
    return found


def main() -> None:
    """The largest difference of every page."""
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
