"""Run the systems of a survey in this process, in several processes, or on a dask cluster.

All three call the same function with the same arguments, so the rows are identical bit for bit; their order may differ. If a worker is
killed, another one repeats its system.
"""

from __future__ import annotations

import os
import sys
from collections.abc import Generator, Sequence
from typing import TYPE_CHECKING

from contvines.shared.processes import ATTEMPTS, may_be_copied, spread

from .plan import PlanError
from .work import Job, Row, work

if TYPE_CHECKING:
    from distributed import Client

LOST = (
    "the process that worked on this system was lost {} times: it may need more memory than there is, or a script that calls for "
    "several processes has no `if __name__ == '__main__':` before the call"
)

Task = tuple[int, dict[str, float], object]


def worked(
    job: Job, tasks: Sequence[Task], workers: int | None, client: str | Client | None
) -> Generator[Row, None, None]:
    """Yield the rows of some systems, in any order.

    Parameters
    ----------
    job : Job
    tasks : sequence of (int, dict, object)
        Index of each system, its parameter values, and the neighbours' start (see `Carrying`) or None.
    workers : int or None
        Number of processes on this computer; None: one per core. 1: this process only.
    client : str or distributed.Client, optional
        A dask cluster instead, or its address.
    """
    if client is not None:
        return cluster(job, tasks, client)
    count = workers or cores()
    if count > 1 and found_here_alone(job.family, *job.outcomes):
        print(
            "the survey runs in one process: no other one finds functions of a notebook; import them from a file to use all cores",
            file=sys.stderr,
        )
        count = 1
    if count == 1 or len(tasks) < 2:
        return (work(job, *task) for task in tasks)
    pieces = [(job, *task) for task in tasks]
    return (row for _, row in spread(work, pieces, count, lambda place: lost(tasks[place][0])))


def lost(index: int) -> Row:
    """Return the row of a system whose worker process died at every attempt."""
    return Row(index, {}, LOST.format(ATTEMPTS))


def cluster(job: Job, tasks: Sequence[Task], client: str | Client) -> Generator[Row, None, None]:
    """Yield the rows of some systems, computed on a dask cluster; `client` is its address or a `distributed.Client`."""
    from distributed import Client, as_completed
    from distributed.scheduler import KilledWorker

    own = isinstance(client, str)
    if own:
        try:
            client = Client(client, timeout=10)
        except (OSError, ValueError) as error:
            raise PlanError(
                f"--cluster {client}: there is no dask scheduler to be reached ({error})"
            ) from None
    try:
        shared = client.scatter(job, broadcast=True, hash=False)
        futures = {
            client.submit(work, shared, *task, pure=False, retries=ATTEMPTS): task[0] for task in tasks
        }
        for future in as_completed(list(futures)):
            index = futures.pop(future)
            try:
                yield future.result()
            except KilledWorker:
                yield lost(index)
            future.release()
    finally:
        if own:
            client.close()


def found_here_alone(*functions: object) -> bool:
    """Whether worker processes cannot import one of these functions: it is defined in a notebook or at the prompt, and processes cannot be forked."""
    main = sys.modules["__main__"]
    return (
        not hasattr(main, "__file__")
        and any("__main__" in (getattr(f, "__module__", ""), type(f).__module__) for f in functions)
        and not may_be_copied()
    )


def cores() -> int:
    """Return the number of cores that this process may use."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1
