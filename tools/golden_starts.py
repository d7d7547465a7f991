"""Write starts.json with a first orbit of every golden machine: `python -m tools.golden_starts`."""

from __future__ import annotations

import json
import tomllib
from pathlib import Path
from typing import Any

from examples.machines.draw import RUNS
from orbits import Absorber, Cavity, Coupled
from orbits.machines.page.loading import load_page
from tests.golden.studies import HERE
from tools.fuzz.drawing import draw

EXAMPLES = HERE.parents[1] / "examples"
MACHINES = {"absorber": Absorber, "cavity": Cavity, "coupled": Coupled}
STRONG = {"restitution": 0.76, "friction": 0.5, "gravity": 0.211, "mass_ratio": 0.006}
COUPLED = {**STRONG, "damping": 1.0, "forcing": 2.47}
AMPLITUDE = {"over": "amplitude", "within": [0.2, 1.2], "depth": 2, "virtual": False}
FREQUENCY = {"over": "frequency", "within": [0.95, 1.05], "depth": 1, "virtual": False}

CHOSEN: dict[str, tuple[str, dict[str, float], str, dict[str, float], dict[str, Any]]] = {
    "strong, virtual too": ("absorber", STRONG, "LR", {"amplitude": 0.55}, {**AMPLITUDE, "virtual": True}),
    "sliding": ("absorber", STRONG, "tt", {"amplitude": 0.5}, {**AMPLITUDE, "within": [0.15, 1.1]}),
    "stick-slip": ("absorber", STRONG, "ss", {"amplitude": 0.18}, {**AMPLITUDE, "within": [0.12, 0.4]}),
    "no friction": ("absorber", {**STRONG, "friction": 0.0}, "LR", {"amplitude": 0.4}, AMPLITUDE),
    "over friction": (
        "absorber", STRONG, "LR", {"amplitude": 0.6},
        {"over": "friction", "within": [0.05, 0.9], "depth": 2, "virtual": False},
    ),
    "inclined": ("cavity", {**STRONG, "slope": 0.01}, "LR", {"amplitude": 0.55}, AMPLITUDE),
    "coupled, sliding": ("coupled", {**COUPLED, "forcing": 1.2}, "tt", {"frequency": 0.99}, FREQUENCY),
    "coupled, stronger": ("coupled", {**COUPLED, "forcing": 3.3}, "LR", {"frequency": 1.02}, FREQUENCY),
    "coupled, over forcing": (
        "coupled", COUPLED, "LR", {"frequency": 1.0},
        {"over": "forcing", "within": [1.0, 4.0], "depth": 1, "virtual": False},
    ),
}  # fmt: skip
DRAWN = {"absorber": range(16), "cavity": range(20), "coupled": range(12)}
UNFINISHED = {
    "absorber 12",
    "cavity 11",
    "cavity 14",
    "cavity 15",
    "cavity 17",
}  # more than 25 branches, so that the set of computed branches depends on their order
SALT = 500


def examples() -> dict[str, Any]:
    """Return the starts of studies in the examples folder with dimensionless machines."""
    found = {}
    for name in ("friction", "friction_low", "frequency", "bouncing_ball"):
        study = tomllib.loads((EXAMPLES / f"{name}.toml").read_text())
        given, start = dict(study["model"]), dict(study["start"])
        kind, word, periods = given.pop("name"), start.pop("word"), start.pop("periods", 1)
        options = {"depth": 2, **study["continue"]}
        options["over"] = options.pop("parameter")
        own = {k: v for k, v in given.items() if k in MACHINES[kind].field_names()}
        values = {**{k: v for k, v in given.items() if k not in own}, **start}
        found[name] = stored(kind, MACHINES[kind](**own).orbit(word, periods, **values), options)
    return found


def stored(kind: str, orbit: Any, options: dict[str, Any]) -> dict[str, Any]:
    """Return a start as plain data."""
    values = dict(orbit.parameters)
    given = {}
    if kind in MACHINES:
        given = {k: v for k, v in values.items() if k in MACHINES[kind].field_names()}
        for name in set(MACHINES[kind].field_names()) - set(given) - {"restitution", "friction"}:
            given[name] = getattr(orbit.model, name)
        values = {k: v for k, v in values.items() if k not in given}
    return {
        "machine": MACHINES[kind].__name__ if kind in MACHINES else kind,
        "given": given,
        "word": getattr(orbit, "spelling", None) or orbit.word.text,
        "periods": orbit.periods,
        "nodes": None
        if kind == "den_hartog.py"
        else orbit.nodes.tolist(),  # its turns in both directions have the same letter t
        "values": values,
        "options": options,
    }


def main() -> None:
    """Compute all starts and write them."""
    found = examples()
    for name, (kind, given, word, values, options) in CHOSEN.items():
        found[name] = stored(kind, MACHINES[kind](**given).orbit(word, 1, **values), options)
    for kind, seeds in DRAWN.items():
        for seed in seeds:
            drawn = draw(kind, SALT, seed)
            if drawn.orbit is not None and f"{kind} {seed}" not in UNFINISHED:
                options = {**drawn.options, "settings": {"max_branches": 25}}
                found[f"{kind} {seed}"] = stored(kind, drawn.orbit, options)
    for name, (parameter, within, _, depth, how, _) in RUNS.items():
        given = dict(how)
        word, start = given.pop("word", None), given.pop("start", None)
        machine = load_page(EXAMPLES / "machines" / f"{name}.py", "machine")
        orbit = machine.orbit(word, **given) if word else machine.attractor(start, **given).orbit
        options = {"over": parameter, "within": within, "depth": depth}
        found[f"page {name}"] = stored(f"{name}.py", orbit, options)
    Path(HERE / "starts.json").write_text(json.dumps(found, indent=1) + "\n")


if __name__ == "__main__":
    main()
