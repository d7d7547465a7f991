"""Ratios of times that have a required value, in one table, for both variants of the native core.

    python -m tools.benchmarks.figures [--rounds 5] [--here]

Processor times in interleaved rounds; ``--here`` measures the core that `CONTVINES_CORE` names, and prints JSON.
"""

import argparse
import json
import os
import statistics
import subprocess
import sys
import time

from contvines.core.build import variants
from contvines.survey import survey

from . import case, large
from .flights import MODELS, Flights
from .floor import FORWARD, PLAIN, Floor, library
from .loci import chart_in_diagrams
from .ours import Diagram
from .survey import ASKED, OUTCOMES, family, plan, warm_diagrams

API = {2: 2.7, 8: 2.6, 32: 2.0, 128: 1.5, 512: 1.3}
SIMULATED = {"absorber": 1.1, "coupled": 1.9}


def public_api(rounds):
    """Time of an additional point through the public API relative to the C loop, {l: ratio}."""
    from .run import by_api, interleaved

    found = {}
    for l in API:
        step = case.STEP / 10 if l < 64 else case.STEP
        points = max(40, min(6000, 200_000 // l))
        floor = Floor(l, FORWARD, PLAIN, points + 1, step)
        seconds = interleaved({"floor": lambda floor=floor: floor.run() - 1}, rounds)["floor"]
        found[l] = by_api(l, step, rounds)[0] / seconds
    return found


def simulations(rounds, count=20000):
    """Time of an impact relative to the C loop, {machine: ratio}."""
    from .run import interleaved

    found = {}
    for name in MODELS:
        flights = Flights(name)
        runs = {
            "ours": lambda f=flights: len(f.ours(count)[0]),
            "floor": lambda f=flights: len(f.floor(count)[0]),
        }
        seconds = interleaved(runs, rounds)
        found[name] = seconds["ours"] / seconds["floor"]
    return found


def survey_in_diagrams(machines=6):
    """Time of a machine in a survey (which also searches for motions without a branch) relative to a single warm diagram."""
    warm_diagrams(3)
    single, begun = warm_diagrams(machines), time.process_time()
    found = survey(family(), plan(machines), **ASKED, outcomes=OUTCOMES, gaps=0, workers=1)
    return (time.process_time() - begun) / found.notes.size / single


def second_diagram(rounds):
    """Processor seconds of a diagram of friction.toml in a warm process."""
    from .run import ROOT

    diagram, seconds = Diagram(ROOT / "examples/friction.toml"), []
    for _ in range(rounds + 1):
        begun = time.process_time()
        diagram.run()
        seconds.append(time.process_time() - begun)
    return statistics.median(seconds[1:])


def measured(rounds):
    """Return (name, required ratio, measured ratio) for the core of this process; the required ratio is None where only an older state is compared."""
    from .run import growth, many_starts, start_up

    compiler = library() is not None
    found = [
        (f"a point through the public API / C loop, l = {l}", API[l], x)
        for l, x in (public_api(rounds) if compiler else {}).items()
    ]
    found.append(("exponent of growth, l = 2 to 4096", "0.9 to 1.1", growth(rounds)[1][0]))
    for name, x in (simulations(rounds) if compiler else {}).items():
        found.append((f"an impact of {name} / C loop", SIMULATED.get(name), x))
    starts = many_starts(rounds, 2000)
    found.append(("a start in a batch / in the simulator", None, starts["one batch"] / starts["one by one"]))
    found.append(("a start of a basin picture / of a census", None, starts["basin"] / starts["census"]))
    found.append(("a machine of a survey, with what has no branch / its diagram", None, survey_in_diagrams()))
    found.append(("a chart / a diagram", None, chart_in_diagrams(1)))
    points = 40
    found.append(
        (
            "sparse, N = 10^4: a point / script's",
            None,
            large.package(100, points)[0] / large.script(100, points),
        )
    )
    seconds = start_up()
    later = seconds["main job, later runs"]
    found.append(("friction.toml: first run / later run", 1.5, seconds["main job, first run"] / later))
    found.append(("friction.toml, later run [s]", 1.5, later))
    found.append(("second diagram in a process [s]", 0.03, second_diagram(rounds)))
    found.append(("contvines --help [s]", 0.15, seconds["contvines --help"]))
    return found


def main(arguments=None):
    """Print the table."""
    parser = argparse.ArgumentParser(prog="python -m tools.benchmarks.figures", description=__doc__)
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--here", action="store_true", help="only this process's core, as JSON")
    options = parser.parse_args(arguments)
    if options.here:
        print(json.dumps(measured(options.rounds)))
        return
    tables = {}
    for name in reversed(variants()):
        command = [
            sys.executable,
            "-m",
            "tools.benchmarks.figures",
            "--here",
            "--rounds",
            str(options.rounds),
        ]
        done = subprocess.run(
            command, env={**os.environ, "CONTVINES_CORE": name}, stdout=subprocess.PIPE, text=True, check=True
        )
        tables[name] = json.loads(done.stdout.splitlines()[-1])
    print(f"| | asked | {' | '.join(tables)} |\n|---|---|{'---|' * len(tables)}")
    for rows in zip(*tables.values()):
        what, asked, _ = rows[0]
        print(
            f"| {what} | {'' if asked is None else asked} | {' | '.join(f'{row[2]:.3g}' for row in rows)} |"
        )


if __name__ == "__main__":
    main()
