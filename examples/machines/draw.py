"""Ten declared machines: one diagram of each, from the machine files beside this one.

Each panel is an automatic diagram of a machine of at most thirty lines; crosses are attractors that simulation reaches from
random starts. `python examples/machines/draw.py [FOLDER] [NAME ...]` draws them all, or only those named.
"""

import sys
from pathlib import Path

import numpy as np

import contvines as cv
from orbits.machines.page.loading import load_page

PAGES = Path(__file__).resolve().parent
GREY = "#9a9a9a"

# machine file: parameter, interval, measure, depth, how the first orbit is found, what a panel is called
RUNS = {
    "impact_oscillator": ("frequency", (2.05, 3.2), "approach_speed", 2, {}, "rigid impact oscillator"),
    "bouncing_ball": (
        "amplitude", (0.02, 0.16), "approach_speed", 2,
        {"start": {"y": 0.1, "v": 0.33, "phase": -0.8}, "amplitude": 0.05}, "ball on a shaking table",
    ),
    "den_hartog": ("frequency", (0.15, 0.95), "max_x", 1, {}, "Den Hartog's oscillator"),
    "belt_slider": ("belt", (0.1, 2.2), "period", 1, {"start": {"x": 1.0, "v": 0.5}}, "slider on a belt"),
    "elastic_stop": ("frequency", (0.6, 1.6), "max_x", 2, {"frequency": 1.5}, "elastic stop"),
    "rubber_wall": ("frequency", (0.55, 1.6), "max_x", 1, {"frequency": 0.8}, "wall lined with rubber"),
    "impact_duffing": ("frequency", (0.5, 1.8), "approach_speed", 1, {}, "two masses that collide"),
    "two_absorbers": (
        "frequency", (1.0, 1.06), "max_q", 1,
        {"start": {"s1": 0.3, "s2": 0.3}, "forcing": 0.03, "frequency": 1.01}, "two unlike absorbers",
    ),
    "absorber": ("amplitude", (0.17, 1.27), "approach_speed", 2, {"word": "LR"}, "reduced absorber"),
    "coupled": ("frequency", (0.97, 1.04), "max_q1", 1, {"word": "LR"}, "absorber on its oscillator"),
}  # fmt: skip


def diagram(name: str):
    """A declared machine and its diagram."""
    machine = load_page(PAGES / f"{name}.py", "machine")
    parameter, within, _, depth, how, _ = RUNS[name]
    given = dict(how)
    word = given.pop("word", None)
    start = given.pop("start", None)
    first = machine.orbit(word, **given) if word else machine.attractor(start, **given)
    return machine, cv.diagram(first, over=parameter, within=within, depth=depth)


def simulated(machine, name: str, count: int = 24) -> list[tuple[float, float]]:
    """(parameter, measure) of the periodic attractors that simulation reaches, one start per value."""
    parameter, within, measure, _, how, _ = RUNS[name]
    settled = {k: v for k, v in how.items() if k not in ("start", "word")}
    generator = np.random.default_rng(3)
    found = []
    for value in np.linspace(*within, count + 2)[1:-1]:
        start = how.get("start") or {s: float(generator.uniform(-0.2, 0.2)) for s in machine.states}
        try:
            attractor = machine.attractor(start, **{**settled, parameter: float(value)})
        except ValueError:  # a start beyond a wall
            continue
        if attractor.orbit is not None and attractor.orbit.stable:
            found.append((float(value), attractor.orbit.measure(measure)))
    return found


def draw(axes, name: str):
    """One panel, or with None for the axes a picture of its own, which is returned."""
    machine, graph = diagram(name)
    _, _, measure, _, _, title = RUNS[name]
    if axes is None:
        figure = graph.plot(y=measure, figsize=(7.2, 4.6))
        panel = figure.axes[0]
        panel.set_xlabel(f"{panel.get_xlabel()} (crosses: simulated)")
    else:
        figure, panel = graph.plot(y=measure, axes=axes, legend=False), axes
        panel.set_title(title)
    panel.plot(*zip(*simulated(machine, name)), "x", color=GREY, ms=4.5, zorder=0)
    kinds = sorted({p.kind for p in graph.special.values() if p.kind != "end"})
    print(f"{name}: {len(graph.branches)} branches; {', '.join(kinds)}")
    worst = max((p.replay for p in graph.special.values() if p.replay is not None), default=0.0)
    print(f"  simulation follows every special orbit to {worst:.1e}")
    return figure


def main() -> None:
    """Draw the panels into one picture."""
    import matplotlib.pyplot as plt

    folder = Path(sys.argv[1] if len(sys.argv) > 1 else "pictures")
    names = sys.argv[2:] or list(RUNS)
    if len(names) == 1:
        figure = draw(None, names[0])
    else:
        columns = min(3, len(names))
        rows = -(-len(names) // columns)
        size = (4.0 * columns, 3.0 * rows)
        figure, panels = plt.subplots(rows, columns, figsize=size, layout="constrained", squeeze=False)
        for axes, name in zip(panels.flat, names):
            draw(axes, name)
        for axes in list(panels.flat)[len(names) :]:
            axes.set_axis_off()
    folder.mkdir(parents=True, exist_ok=True)
    figure.savefig(folder / "machines.png", dpi=160)
    print(folder / "machines.png")


if __name__ == "__main__":
    main()
