"""The absorber from Python: a diagram, its special orbits, and a file to come back to."""

import contvines as cv
from orbits import Absorber


def main(path="absorber.vines", picture="absorber.png"):
    """Compute, print, draw and save; returns the graph."""
    absorber = Absorber(restitution=0.76, friction=0.5, gravity=0.211, mass_ratio=0.006)
    seed = absorber.symmetric_orbit(amplitude=0.55)
    graph = cv.diagram(seed, over="amplitude", within=(0.2, 1.3), depth=3)
    print(graph)
    for point in graph.of_kind("symmetry-breaking"):
        print(f"{point.label}: amplitude^2 = {point.value**2:.10f}, {point.criticality}")
    graph.plot(y="B").savefig(picture)
    graph.save(path)
    return graph


if __name__ == "__main__":
    main()
