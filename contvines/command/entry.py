"""The console script: it runs the command line, and handles Ctrl-C and warnings from the first moment on."""

import sys
import warnings


def main() -> None:
    """Run `contvines`; an interrupt becomes a message and exit status 130."""
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
    """Print a warning as one line on stderr; warnings of libraries with their place in the code."""
    place = "" if category is UserWarning else f"{filename}:{lineno}: {category.__name__}: "
    print(f"contvines: {place}{message}", file=sys.stderr)


def _unraisable(problem: "sys.UnraisableHookArgs") -> None:
    """Repeat a Ctrl-C that arrived in a callback, where Python can only ignore it.

    It is repeated a little later: at once, it would arrive in this function and be ignored again.
    """
    if problem.exc_type is not None and issubclass(problem.exc_type, KeyboardInterrupt):
        import _thread

        _thread.start_new_thread(_again, ())  # `threading` would wait for the thread to start
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
