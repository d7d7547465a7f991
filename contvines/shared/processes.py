"""Work spread over processes of this machine: each does one piece at a time, and one that is lost loses that piece alone.

Processes begin as copies of this one where that is safe, else from nothing. A copy has all modules and compiled functions at once; a
process that begins from nothing spends a second or two of processor time on them. But a copy has only the thread that made it: what
another one had locked stays locked for ever. So there are copies on Linux only (libraries of other systems do not bear them), and only
of a process with one thread.
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

THREADS = Path("/proc/self/task")  # a folder per thread
ATTEMPTS = 3  # at one piece whose process is lost
PATIENCE = 10.0  # seconds until a copy that does nothing counts as stuck


def may_be_copied() -> bool:
    """Whether a copy of this process can go on by itself."""
    if not sys.platform.startswith("linux") or threading.active_count() > 1 or not THREADS.is_dir():
        return False
    if _threads() > 1:
        # libraries of linear algebra keep threads that they end before a process is copied, and begin anew when they need them: after
        # an idle copy those that are left belong to somebody who knows nothing of copies
        return _idle_copy_ends() and _threads() == 1
    return True


def _threads() -> int:
    return len(list(THREADS.iterdir()))


def _idle_copy_ends() -> bool:
    """Whether a copy that does nothing ends: what libraries do where one begins may wait for a thread that is not in it."""
    from multiprocessing.connection import wait

    end, other = os.pipe()  # it is at its end where nobody holds the other one
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", DeprecationWarning)  # Python's own, of copies beside threads
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
    """``work(*piece)`` of each piece in `count` processes: the piece's place and its result, as they come.

    Where the iteration is left early (close it), the processes are ended amid their work.

    Parameters
    ----------
    work : callable
        To be found by its name, as whatever the pieces consist of.
    pieces : sequence of tuple
    count : int
    lost : callable
        ``lost(place)`` stands for the result of a piece whose process ended `ATTEMPTS` times, and of all that are left where that many
        processes in a row ended before they could begin.

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
            yield from answers  # while the next pieces are worked on
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
    """One process, from the side of that which asks: `ready` once it has begun, `place` of the piece that it works on."""

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
        with suppress(OSError):  # it has ended, which is noticed where its answer is read
            self.connection.send(pieces[place])

    def end(self) -> None:
        self.process.kill()  # it has nothing to put in order, and a signal that it may refuse would be waited for
        self.process.join()
        self.connection.close()


def _serve(connection: Connection, work: Callable[..., Any]) -> None:
    """What such a process does."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # the process that asks decides when to stop
    signal.signal(signal.SIGTERM, signal.SIG_DFL)
    gc.freeze()  # what a copy begins with is never looked through: that would copy its memory, page by page
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
    """The error itself, or one with its words where it cannot be sent."""
    try:
        pickle.loads(pickle.dumps(error))
    except Exception:
        return RuntimeError(f"{type(error).__name__}: {error}")
    return error


def _end_with_parent() -> None:
    """A process that is killed outright cannot end its workers: they would wait for it for ever."""
    from multiprocessing import parent_process

    parent = parent_process()
    if parent is not None:
        parent.join()
        os._exit(1)
