"""The console script: the command line, with Ctrl-C in good order from the first moment."""

import sys
import warnings


def main() -> None:
    """Run `contvines`; an interrupt ends as a sentence with exit status 130."""
    sys.unraisablehook = _unraisable
    warnings.showwarning = _one_line
    try:
        from contvines.command.cli import main as run

        run()
    except KeyboardInterrupt:
        print("contvines: stopped; nothing new is kept; run the same command again.", file=sys.stderr)
        sys.exit(130)


def _one_line(
    message: Warning | str, category: type[Warning], filename: str, lineno: int, *where: object
) -> None:
    """A warning as a sentence on stderr; of a library's with its place."""
    place = "" if category is UserWarning else f"{filename}:{lineno}: {category.__name__}: "
    print(f"contvines: {place}{message}", file=sys.stderr)


def _unraisable(problem: "sys.UnraisableHookArgs") -> None:
    """A Ctrl-C that fell into a callback, where Python can only ignore it, is given again a little later.

    Not at once: that would fall into this function, and be ignored again.
    """
    if problem.exc_type is not None and issubclass(problem.exc_type, KeyboardInterrupt):
        import _thread

        _thread.start_new_thread(_again, ())  # does not wait for the thread, as `threading` would
    else:
        sys.__unraisablehook__(problem)


def _again() -> None:
    """Interrupt the main thread as soon as it has left the hook."""
    import _thread
    import threading
    import time

    main = threading.main_thread().ident
    while True:
        time.sleep(0.02)
        frame = sys._current_frames().get(main or 0)
        while frame is not None and frame.f_code is not _unraisable.__code__:
            frame = frame.f_back
        if frame is None:
            return _thread.interrupt_main()
