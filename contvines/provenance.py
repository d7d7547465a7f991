"""With what a result was made: versions, platform, core and date, as plain data that files and exports carry."""

from __future__ import annotations

import json
import platform
from datetime import UTC, datetime
from importlib.metadata import PackageNotFoundError, version
from typing import TYPE_CHECKING, Any

from .core.library import variant

if TYPE_CHECKING:
    from .interrupts import Resumable

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


def carried(result: Resumable) -> dict[str, Any]:
    """What an export of a result says of its making: ``made``, of a result from a file as the file has it, ``settings``, and the ``study``, where the file keeps one."""
    about = {"made": result.origin.get("made") or provenance(), "settings": getattr(result, "settings", {})}
    study = result.origin.get("study")
    return {**about, "study": study} if study else about


def comments(result: Resumable) -> list[str]:
    """`carried` in lines of comments for people: with what it was made, and the study."""
    about = carried(result)
    study = about.get("study") or {}
    source = study.get("source") or {}
    said = source.get("text") or json.dumps(study)
    named = f"contvines {source.get('command', '')} {source.get('study', '')}".rstrip()
    return [as_text(about["made"]), *([f"{named}, the study:", *said.splitlines()] if study else [])]


def as_text(made: dict[str, str]) -> str:
    """One line for people; empty for a file that does not say with what it was made."""
    if not made:
        return ""
    return (
        f"made {made.get('date', '')} with contvines {made.get('contvines', '?')}, numpy {made.get('numpy', '?')}, "
        f"scipy {made.get('scipy', '?')}, Python {made.get('python', '?')}, {made.get('core', '?')} core, {made.get('platform', '?')}"
    )
