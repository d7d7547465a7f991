"""`python -m tools.benchmarks`: tables of ratios, growth with the length of the word, simulation, start-up.

Times are medians of interleaved rounds, so that other load affects all programs equally. Compare ratios; absolute times
are those of the computer that is named. No benchmark passes or fails by time.
"""

import argparse
import os
import platform
import shutil
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np
import scipy

from contvines.core.library import variant as core

from . import case, figures, scripts
from .auto import Auto
from .flights import MODELS, Flights
from .floor import FORWARD, ORTHOGONAL, PLAIN, VECTOR, Floor, library
from .loci import REPETITIONS, chart_in_diagrams, ratios
from .ours import Core, Diagram, PublicAPI
from .starts import Starts

ROOT = Path(__file__).parents[2]
LENGTHS = (2, 8, 32, 128, 512)
STUDIES = ("friction", "friction_low", "frequency")
GROWTH = tuple(2**k for k in range(1, 13))


def machine():
    """Return a line with the processor and the versions."""
    model = platform.processor() or platform.machine()
    cpuinfo = Path("/proc/cpuinfo")
    if cpuinfo.exists():
        names = [
            line.split(":")[1].strip() for line in cpuinfo.read_text().splitlines() if "model name" in line
        ]
        model = names[0] if names else model
    compiler = (
        shutil.which("cc") and subprocess.run(["cc", "--version"], capture_output=True, text=True).stdout
    )
    return (
        f"{model}, {os.cpu_count()} cores; {platform.system()}; Python {platform.python_version()}, "
        f"numpy {np.__version__}, scipy {scipy.__version__}, {core()}; "
        f"C compiler: {(compiler or 'none').splitlines()[0]}"
    )


def interleaved(competitors, rounds, least=4e-3):
    """Return median seconds per point of each program over interleaved rounds; each callable returns its number of points."""
    times = {name: [] for name in competitors}
    for run in competitors.values():
        run()
    for _ in range(rounds):
        for name, run in competitors.items():
            begin = time.process_time()
            points = run()
            while time.process_time() - begin < least:
                points += run()
            times[name].append((time.process_time() - begin) / points)
    return {name: statistics.median(found) for name, found in times.items()}


def competitors(l, points, step, slow):
    """Return name -> function that computes points and returns their number."""
    count = points + 1
    found = {}
    if library() is not None:
        for name, eliminate, flags in (
            ("C floor", FORWARD, PLAIN),
            ("C floor, vectorised sines", FORWARD, VECTOR),
            ("C floor, orthogonal", ORTHOGONAL, PLAIN),
        ):
            floor = Floor(l, eliminate, flags, count, step)
            found[name] = lambda floor=floor: floor.run() - 1
    core = Core(l, count, step)
    found["contvines, compiled loop"] = lambda: core.run() - 1
    few = max(3, min(30, 4000 // l))
    found["scipy.sparse script"] = lambda: len(scripts.sparse(l, few)[0]) - 1
    if slow:
        found["numpy script"] = lambda: len(scripts.dense(l, few)[0]) - 1
        found["scipy fsolve"] = lambda: len(scripts.by_fsolve(l, few)[0]) - 1
    return found


def by_auto(auto, l, rounds):
    """Median seconds per point; short runs are subtracted from long ones, so that the start of the program does not count."""
    points = {2: 20000, 8: 5000, 32: 500, 128: 12}.get(l)
    if points is None:
        return None
    step = 0.3 / points
    found = []
    for _ in range(rounds):
        short, few = auto.run(l, 2, step)
        long, many = auto.run(l, points, step)
        found.append((long - short) / (len(many) - len(few)))
    return statistics.median(found)


def by_api(l, step, rounds):
    """Return seconds per point of the public API (difference of long and short branches), and seconds per branch."""
    long, short = PublicAPI(l, step), PublicAPI(l, 4.0 * step)
    points = long.run(), short.run()
    times = interleaved(
        {"long": lambda: long.run() / points[0], "short": lambda: short.run() / points[1]}, rounds
    )
    each = (times["long"] - times["short"]) / (points[0] - points[1])
    return each, times["short"] - each * points[1]


def continuation(rounds, lengths=LENGTHS):
    """Return times per point, {name: {l: seconds}}."""
    table = {}
    auto = Auto()
    for l in lengths:
        # long branches, so that one-time work per branch counts little; all programs take the same steps
        step = case.STEP / 10 if l < 64 else case.STEP
        points = max(40, min(6000, 200_000 // l))
        for name, seconds in interleaved(competitors(l, points, step, l <= 128), rounds).items():
            table.setdefault(name, {})[l] = seconds
        each, once = by_api(l, step, rounds)
        table.setdefault("contvines, public API", {})[l] = each
        table.setdefault("  the same, once per branch", {})[l] = once
        if auto.available:
            seconds = by_auto(auto, l, 3)
            if seconds is not None:
                table.setdefault("AUTO-07p (no multipliers)", {})[l] = seconds
    return table


def growth(rounds, lengths=GROWTH):
    """Return seconds per point of the compiled loop for each l (forty points), and exponents of growth: for all lengths, and from 32 on."""
    seconds = []
    for l in lengths:
        core = Core(l, 41)
        seconds.append(interleaved({"loop": lambda core=core: core.run() - 1}, rounds)["loop"])
    logs = np.log(lengths), np.log(seconds)
    late = np.array(lengths) >= 32
    slopes = [
        np.polyfit(logs[0][part], logs[1][part], 1)[0] for part in (late | True, late) if part.sum() > 1
    ]
    return dict(zip(lengths, seconds)), slopes


def whole_diagrams(rounds, studies=STUDIES):
    """Return times of whole diagrams of examples in a warm process and of the compiled loop, {name: {study: seconds}}, and the diagrams' sizes."""
    table, sizes = {}, {}
    for study in studies:
        diagram, core = Diagram(ROOT / "examples" / f"{study}.toml"), Core(2)
        points = diagram.run()
        times = interleaved({"whole diagram": diagram.run, "compiled loop": core.run}, rounds)
        graph = diagram.graph
        sizes[study] = f"{len(graph.branches)} branches, {len(graph.special)} special points, {points} points"
        for name, seconds in times.items():
            table.setdefault(f"{name}, a point", {})[study] = seconds
        table.setdefault("whole diagram", {})[study] = points * times["whole diagram"]
    return table, sizes


def simulation(rounds, count=20000):
    """Return times per impact, {model: {name: seconds}}."""
    table = {}
    for name in MODELS:
        flights = Flights(name)
        runs = {"contvines": lambda f=flights: len(f.ours(count)[0])}
        if library("simulation.c") is not None:
            runs["C floor"] = lambda f=flights: len(f.floor(count)[0])
        for method in ("DOP853", "LSODA", "RK45"):
            runs[f"solve_ivp {method}"] = lambda f=flights, m=method: len(f.solve_ivp(10, m)[0])
        table[name] = interleaved(runs, rounds)
    return table


def many_starts(rounds, count=10_000):
    """Return processor seconds per start, {name: seconds}, from interleaved rounds."""
    starts = Starts(count)
    work = {
        "one batch": starts.batch,
        "one by one": starts.plain,
        "basin": starts.basin,
        "census": starts.census,
    }
    times = {name: [] for name in work}
    for k in range(rounds + 1):
        for name, run in work.items():
            begin = time.process_time()
            run()
            if k:  # the first round fills caches
                times[name].append((time.process_time() - begin) / count)
    return {name: statistics.median(found) for name, found in times.items()}


def start_up(repeats=3):
    """Return processor seconds of commands in separate processes, {command: seconds}."""
    found = {}
    with tempfile.TemporaryDirectory() as directory:
        environment = {**os.environ, "PYTHONPATH": str(ROOT)}

        def timed(*arguments):
            command = [sys.executable, "-c", "from contvines.command.entry import main; main()", *arguments]
            begin = os.times()
            done = subprocess.run(command, cwd=directory, env=environment, capture_output=True, text=True)
            end = os.times()
            seconds = (end.children_user + end.children_system) - (
                begin.children_user + begin.children_system
            )
            if done.returncode:
                raise SystemExit(f"contvines {' '.join(arguments)} failed: {done.stderr.strip()}")
            return seconds

        def job(i):
            return timed(
                "diagram", str(ROOT / "examples/friction.toml"), "-o", f"{i}.vines", "--plot", f"{i}.png"
            )

        timed("--help")
        found["contvines --help"] = statistics.median(timed("--help") for _ in range(repeats))
        found["main job, first run"] = job("first")
        found["main job, later runs"] = statistics.median(job(i) for i in range(repeats))
    return found


def show(title, names, columns, cell):
    """Print a table."""
    width = max(map(len, names)) + 2
    print(f"\n{title}\n" + "".ljust(width) + "".join(f"{column:>12}" for column in columns))
    for name in names:
        print(name.ljust(width) + "".join(f"{cell(name, column):>12}" for column in columns))


def two_parameters(rounds, repetitions):
    """Print the processor time of a point of a locus, in seconds and relative to a point of its branch."""
    seconds, times, exponents = ratios(rounds, repetitions)
    lengths = [2 * count for count in repetitions]
    columns = [f"l={l}" for l in lengths]
    of = dict(zip(columns, lengths))
    show(
        "microseconds per point of a locus",
        seconds,
        columns,
        lambda kind, c: number(seconds[kind][of[c]], 1e6),
    )
    show("times a point of its branch", times, columns, lambda kind, c: number(times[kind][of[c]]))
    if exponents:
        print("exponent from l=32: " + ", ".join(f"{slope:.2f} {kind}" for kind, slope in exponents.items()))
    print(f"chart of amplitude and friction: {chart_in_diagrams(rounds):.1f} diagrams")


def number(value, scale=1.0):
    """Format a number with three digits; None is a dash."""
    if value is None:
        return "-"
    value *= scale
    return f"{value:.0f}" if value >= 1000 else f"{value:.3g}"


def main(arguments=None):
    """Print the tables."""
    parser = argparse.ArgumentParser(prog="python -m tools.benchmarks", description=__doc__)
    parser.add_argument("--rounds", type=int, default=9, help="interleaved rounds; medians are shown")
    parser.add_argument("--quick", action="store_true", help="three rounds, short words, no start-up")
    options = parser.parse_args(arguments)
    rounds = 3 if options.quick else options.rounds
    lengths = (2, 32) if options.quick else LENGTHS
    print(machine())

    table = continuation(rounds, lengths)
    columns = [f"l={l}" for l in lengths]
    of = dict(zip(columns, lengths))
    show("microseconds per point", table, columns, lambda name, c: number(table[name].get(of[c]), 1e6))
    for base in ("C floor", "C floor, orthogonal"):
        if base in table:

            def ratio(name, column, base=base):
                seconds = table[name].get(of[column])
                return number(seconds and seconds / table[base][of[column]])

            show(f"times the {base}", [name for name in table if name[0] != " "], columns, ratio)

    seconds, slopes = growth(rounds, (2, 8, 32, 128) if options.quick else GROWTH)
    show(
        "growth of the compiled loop, microseconds per point",
        ["loop"],
        seconds,
        lambda _, l: number(seconds[l], 1e6),
    )
    print(
        "exponent: "
        + ", ".join(f"{slope:.2f} {what}" for slope, what in zip(slopes, ("overall", "from l=32")))
    )

    table, sizes = whole_diagrams(rounds, STUDIES[:1] if options.quick else STUDIES)
    show(
        "whole diagrams in a warm process, microseconds",
        list(table),
        list(sizes),
        lambda name, study: number(table[name][study], 1e6),
    )
    for study, size in sizes.items():
        times = table["whole diagram, a point"][study] / table["compiled loop, a point"][study]
        print(f"{study}: {size}; {times:.0f} times the compiled loop")

    two_parameters(3, REPETITIONS[:2] if options.quick else REPETITIONS)

    times = many_starts(rounds, 2000 if options.quick else 10_000)
    show(
        "microseconds per start (100 periods, 200 impacts)",
        list(times),
        ["absorber"],
        lambda name, _: number(times[name], 1e6),
    )
    print(
        f"one batch: {60e-6 / times['one batch']:.2f} million starts a minute and core, "
        f"{times['one batch'] / times['one by one']:.2f} times the plain simulator; "
        f"a basin picture takes {times['basin'] / times['census']:.2f} times as many starts"
    )

    flights = simulation(rounds, 2000 if options.quick else 20000)
    names = list(next(iter(flights.values())))
    show(
        "nanoseconds per impact", names, list(flights), lambda name, model: number(flights[model][name], 1e9)
    )
    if "C floor" in names:
        show(
            "times the C floor",
            names,
            list(flights),
            lambda name, model: number(flights[model][name] / flights[model]["C floor"]),
        )
    if not options.quick:
        times = start_up()
        show("seconds", list(times), ["processor"], lambda name, _: number(times[name]))
        print("\nfigures of the design, both variants of the core")
        figures.main(["--rounds", str(rounds)])


if __name__ == "__main__":
    main()
