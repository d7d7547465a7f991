"""Work in several processes of this computer: each does one piece at a time, and if a process dies only its piece must be repeated.

Processes are forked from this one if that is safe, otherwise spawned. A fork has all modules and compiled functions at once; a spawned
process spends a second or two of processor time on them. But a fork has only the thread that made it: a lock that another thread held
stays locked for ever. Processes are therefore forked only on Linux (libraries of other systems do not support it), and only from a
process with one thread.
"""

from __future__ import annotations

import gc
import os
import pickle
import signal
import sys
import threading
import traceback
import warnings
from collections.abc import Callable, Generator, Sequence
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from multiprocessing.connection import Connection

THREADS = Path("/proc/self/task")  # has a folder per thread of this process
ATTEMPTS = 3  # attempts at a piece of work whose process dies
PATIENCE = 10.0  # seconds after which a fork that should end at once counts as stuck


def may_be_copied() -> bool:
    """Whether this process can be forked safely."""
    if not sys.platform.startswith("linux") or threading.active_count() > 1 or not THREADS.is_dir():
        return False
    if _threads() > 1:
        # libraries of linear algebra end their threads before a fork and restart them when needed: threads that are left after an idle
        # fork belong to code that does not support forks
        return _idle_copy_ends() and _threads() == 1
    return True


def _threads() -> int:
    return len(list(THREADS.iterdir()))


def _idle_copy_ends() -> bool:
    """Whether a fork that does nothing ends: handlers of libraries that run at a fork may wait for a thread that it does not have."""
    from multiprocessing.connection import wait

    # `end` becomes readable once all processes have closed `other`: at the fork's exit
    end, other = os.pipe()
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", DeprecationWarning)  # Python warns of forks beside threads
        copy = os.fork()
    if copy == 0:
        os._exit(0)
    os.close(other)
    ended = bool(wait([end], PATIENCE))
    if not ended:
        os.kill(copy, signal.SIGKILL)
    os.waitpid(copy, 0)
    os.close(end)
    return ended


def spread(
    work: Callable[..., Any], pieces: Sequence[tuple[Any, ...]], count: int, lost: Callable[[int], Any]
) -> Generator[tuple[int, Any], None, None]:
    """Call ``work(*piece)`` for each piece in `count` processes; yield (index of the piece, result) in the order of completion.

    Closing the generator early kills the processes.

    Parameters
    ----------
    work : callable
        It and the pieces must be picklable.
    pieces : sequence of tuple
    count : int
        Number of processes.
    lost : callable
        ``lost(index)`` is the result of a piece whose process died `ATTEMPTS` times, and of all pieces left if that many processes in a
        row died before they could begin.

    Raises
    ------
    Exception
        Whatever `work` raises.
    """
    from multiprocessing.connection import wait

    waiting, attempts = list(range(len(pieces)))[::-1], [0] * len(pieces)
    left, stillborn = len(pieces), 0
    team: dict[Any, _Worker] = {}
    answers: list[tuple[int, Any]] = []
    try:
        while left:
            for _ in range(min(count, left) - len(team) if stillborn < ATTEMPTS else 0):
                worker = _Worker(work)
                team[worker.connection] = worker
            if not team:
                answers += [(place, lost(place)) for place in waiting[::-1]]
                break
            for worker in team.values():
                if worker.ready and worker.place is None and waiting:
                    worker.give(waiting.pop(), pieces)
            yield from answers  # meanwhile the workers do the next pieces
            answers = []
            for connection in wait(list(team)):
                worker = team[connection]
                place, worker.place = worker.place, None
                try:
                    failed, value = worker.connection.recv()
                except (EOFError, OSError):
                    team.pop(connection).end()
                    stillborn += not worker.ready
                    if place is None:
                        continue
                    attempts[place] += 1
                    if attempts[place] < ATTEMPTS:
                        waiting.append(place)
                    else:
                        answers.append((place, lost(place)))
                        left -= 1
                    continue
                if not worker.ready:
                    worker.ready, stillborn = True, 0
                elif failed:
                    yield from answers
                    raise value
                else:
                    assert place is not None
                    answers.append((place, value))
                    left -= 1
        yield from answers
    finally:
        for worker in team.values():
            worker.end()


class _Worker:
    """A worker process as the parent sees it: `ready` once it has begun, and the index `place` of its piece."""

    def __init__(self, work: Callable[..., Any]) -> None:
        from multiprocessing import get_context

        context = get_context("fork") if may_be_copied() else get_context("spawn")
        self.connection, other = context.Pipe()
        self.process = context.Process(target=_serve, args=(other, work))
        self.process.start()
        other.close()
        self.ready, self.place = False, None

    def give(self, place: int, pieces: Sequence[tuple[Any, ...]]) -> None:
        self.place = place
        with suppress(OSError):  # the worker has died, which is noticed when its answer is read
            self.connection.send(pieces[place])

    def end(self) -> None:
        self.process.kill()  # not terminate: the worker could ignore that signal, and `join` would wait for ever
        self.process.join()
        self.connection.close()


def _serve(connection: Connection, work: Callable[..., Any]) -> None:
    """Main loop of a worker process: receive pieces, send back (failed, result or error)."""
    # Ctrl-C reaches all processes; the parent decides when to stop
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    signal.signal(signal.SIGTERM, signal.SIG_DFL)
    gc.freeze()  # the collector would write to inherited objects and so copy the parent's memory, page by page
    gc.set_threshold(200_000, 20, 100)
    threading.Thread(target=_end_with_parent, daemon=True).start()
    connection.send((False, None))
    while True:
        try:
            answer = False, work(*connection.recv())
        except Exception as error:
            error.add_note(traceback.format_exc())
            answer = True, _portable(error)
        try:
            connection.send(answer)
        except (TypeError, AttributeError, pickle.PicklingError) as error:  # a result that cannot be sent
            connection.send((True, error))


def _portable(error: Exception) -> Exception:
    """Return the error, or a RuntimeError with its text if it cannot be pickled."""
    try:
        pickle.loads(pickle.dumps(error))
    except Exception:
        return RuntimeError(f"{type(error).__name__}: {error}")
    return error


def _end_with_parent() -> None:
    """Wait for the parent process and exit when it ends; a killed parent cannot end its workers, which would wait for ever."""
    from multiprocessing import parent_process

    parent = parent_process()
    if parent is not None:
        parent.join()
        os._exit(1)
