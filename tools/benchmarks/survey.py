"""Survey of 500 frequency responses of the coupled machine over clearance and restitution.

The file must be the same from one process, from two, and from a dask cluster of two workers one of which is killed half way. Times of one and two
processes are compared, and the time per machine with that of one warm diagram.

    python -m tools.benchmarks.survey [--machines 500] [--skip-cluster]

Wall times are reliable only without other load; processor times are printed, too.
"""

from __future__ import annotations

import argparse
import os
import resource
import signal
import statistics
import tempfile
import time
from pathlib import Path

import numpy as np

import contvines as cv
from contvines.survey import load_survey, planned, survey
from orbits.design import Family
from orbits.machines.physical import physical

CASE = {
    "oscillator_mass": "3.8 kg", "natural_frequency": "8 Hz", "damping_ratio": 0.007, "absorber_mass": "32 g", "half_width": "14 mm",
    "restitution": 0.6, "friction": 0.1, "base_amplitude": "0.3 mm", "frequency": "7.9 Hz",
}  # fmt: skip
ASKED = {"over": "frequency", "within": (7.0, 9.0), "depth": 1}
SAMPLE = 12  # machines of the survey whose diagrams are also computed one by one
OUTCOMES = ("peak", "lower_peak", "covered", "stable:LR")


def family():
    return Family(physical("coupled", CASE), "LR", over="frequency", within=ASKED["within"])


def plan(machines):
    rows = max(round(machines / 25), 1)
    return {
        "half_width": np.linspace(10.0, 18.0, rows).tolist(),
        "restitution": np.linspace(0.5, 0.7, max(machines // rows, 1)).tolist(),
    }


def spent():
    """Processor time of this process and of its children that have ended."""
    return sum(sum(resource.getrusage(who)[:2]) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN))


def made(folder, name, machines, **options):
    """Compute a survey; return it as read from its file, and the times."""
    begun, used = time.perf_counter(), spent()
    found = survey(family(), plan(machines), **ASKED, outcomes=OUTCOMES, gaps=0, **options)
    took = time.perf_counter() - begun, spent() - used
    found.save(folder / f"{name}.nc")
    print(f"{name}: {took[0]:.1f} s, processor {took[1]:.1f} s, {found.failed} failed", flush=True)
    return load_survey(folder / f"{name}.nc"), took


def on_a_cluster(folder, machines):
    """Compute the survey on a cluster, and kill a worker after half of the rows."""
    from distributed import LocalCluster

    killed, seen = [], []
    with LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None) as cluster:

        def kill(row):
            seen.append(row.index)
            if not killed and len(seen) >= machines // 2:
                killed.append(next(iter(cluster.workers.values())).pid)
                os.kill(killed[0], signal.SIGKILL)

        found, _ = made(folder, "cluster", machines, cluster=cluster.scheduler_address, progress=kill)
    assert killed, "no worker was killed"
    return found


def same(a, b):
    """Whether two surveys are equal in all values, notes and axes."""
    return (
        list(a.columns) == list(b.columns)
        and all(np.array_equal(a[name], b[name], equal_nan=True) for name in a.columns)
        and np.array_equal(a.notes, b.notes)
        and a.about == b.about
    )


def warm_diagrams(machines):
    """Mean processor time of single diagrams of some of the machines in a warm process, including their seeds; median of three rounds each."""
    made_by = family()
    systems = planned(plan(machines)).systems()
    chosen = systems[:: max(len(systems) // SAMPLE, 1)]
    times = []
    for values in chosen:
        rounds = []
        for _ in range(3):
            used = time.process_time()
            cv.diagram(made_by(values), **ASKED)
            rounds.append(time.process_time() - used)
        times.append(statistics.median(rounds))
    return statistics.mean(times)


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--machines", type=int, default=500)
    parser.add_argument("--skip-cluster", action="store_true")
    parser.add_argument("--depth", type=int, default=1)
    asked = parser.parse_args()
    ASKED["depth"] = asked.depth
    warm_diagrams(3)
    single = warm_diagrams(asked.machines)
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        one, (wall, used) = made(folder, "one process", asked.machines, workers=1)
        count = one.notes.size
        two, (wall_two, _) = made(folder, "two processes", asked.machines, workers=2)
        print(f"one and two processes give the same file: {same(one, two)}")
        if not asked.skip_cluster:
            print(f"a cluster that loses a worker, too: {same(one, on_a_cluster(folder, asked.machines))}")
    print(
        f"a single warm diagram: {1e3 * single:.1f} ms; a machine of the survey: {1e3 * used / count:.1f} ms, {used / count / single:.2f} times"
    )
    print(f"two processes: {wall / wall_two:.2f} times faster")


if __name__ == "__main__":
    main()
