"""With what a result was made: versions, platform, core and date, as plain data that files and exports carry."""

from __future__ import annotations

import platform
from datetime import UTC, datetime
from importlib.metadata import PackageNotFoundError, version

from .core.library import variant

PACKAGES = ("contvines", "numpy", "scipy")


def version_of(package: str) -> str | None:
    """The installed version of a package; None where it is not installed."""
    try:
        return version(package)
    except PackageNotFoundError:
        return None


def provenance() -> dict[str, str]:
    """Versions of contvines, numpy, scipy and Python, the platform, the core that computes, and the date in UTC.

    Returns
    -------
    dict of str to str
        Keys ``contvines``, ``numpy``, ``scipy``, ``python``, ``platform``, ``core`` and ``date`` (ISO 8601, to the second).
    """
    found = {name: version_of(name) or "unknown" for name in PACKAGES}
    return {
        **found,
        "python": platform.python_version(),
        "platform": f"{platform.system()} {platform.machine()}",
        "core": variant(),
        "date": datetime.now(UTC).isoformat(timespec="seconds"),
    }


def as_text(made: dict[str, str]) -> str:
    """One line for people; empty for a file that does not say with what it was made."""
    if not made:
        return ""
    return (
        f"made {made.get('date', '')} with contvines {made.get('contvines', '?')}, numpy {made.get('numpy', '?')}, "
        f"scipy {made.get('scipy', '?')}, Python {made.get('python', '?')}, {made.get('core', '?')} core, {made.get('platform', '?')}"
    )
