"""Compile the native core: ``python -m contvines.core.build`` in a checkout; ``hatch_build.py`` does it for wheels.

This file uses the standard library only, so that a build can run it before any package is installed.
"""

from __future__ import annotations

import hashlib
import os
import platform
import shlex
import shutil
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from functools import partial
from pathlib import Path

HERE = Path(__file__).resolve().parent
SOURCES = HERE.parents[1] / "native"
SUFFIX = {"win32": ".dll", "darwin": ".dylib"}.get(sys.platform, ".so")
VARIANTS = {"baseline": (), "avx2": ("-mavx2",)}
FLAGS = (
    "-std=c++20",
    "-O3",
    "-fno-exceptions",
    "-fno-rtti",
    "-ffp-contract=off",
    "-fno-math-errno",
    "-fno-trapping-math",
    "-fvisibility=hidden",
)
ZIG = "ziglang==0.13.0"
"""Requirement of a wheel with a compiler, which a build installs if the system has no compiler."""


class NotBuilt(Exception):
    """The native core cannot be compiled; the message gives the reason."""


def variants() -> tuple[str, ...]:
    """Return the names of the variants of the core for this computer's processor."""
    return ("baseline", "avx2") if platform.machine().lower() in ("x86_64", "amd64") else ("baseline",)


def path_of(variant: str, folder: Path = HERE) -> Path:
    """Return the path of a variant's library."""
    return folder / f"libcontvines-{variant}{SUFFIX}"


def digest(sources: Path = SOURCES) -> str:
    """Return the digest of all native sources and the compiler flags."""
    found = hashlib.blake2b(repr((FLAGS, VARIANTS)).encode(), digest_size=8)
    for file in sorted(sources.iterdir()):
        if file.suffix in (".h", ".hpp", ".cpp"):
            found.update(file.name.encode() + file.read_bytes())
    return found.hexdigest()


def up_to_date(folder: Path = HERE) -> bool:
    """Whether the libraries in a folder were built from the sources of this checkout, whose digest they contain as text."""
    mark = digest().encode()
    paths = [path_of(variant, folder) for variant in variants()]
    return all(path.exists() and mark in path.read_bytes() for path in paths)


def compiler() -> list[str] | None:
    """Return the command of the system's C++ compiler: the first of ``CXX``, c++, g++, clang++ that accepts the flags; None if there is none."""
    given = shlex.split(os.environ.get("CXX", ""))
    named = [given, *([name] for name in ("c++", "g++", "clang++"))]
    return next(
        (command for command in named if command and shutil.which(command[0]) and _accepts(command)), None
    )


def _accepts(command: list[str]) -> bool:
    """Whether a compiler accepts the flags; old versions do not."""
    done = subprocess.run([*command, *FLAGS, "-fsyntax-only", "-x", "c++", os.devnull], capture_output=True)
    return done.returncode == 0


def ziglang_command(target: str = "") -> list[str] | None:
    """Return the command of the compiler in the wheel `ziglang`; None if it is not installed."""
    from importlib.util import find_spec

    if find_spec("ziglang") is None:
        return None
    return [sys.executable, "-m", "ziglang", "c++", *(["-target", target] if target else [])]


def build(folder: Path = HERE, command: list[str] | None = None) -> list[Path]:
    """Compile all variants for this computer's processor into a folder.

    Parameters
    ----------
    folder : Path
    command : list of str, optional
        Of the compiler; by default the system's, or that of zig if there is none.

    Returns
    -------
    list of Path
        The libraries.

    Raises
    ------
    NotBuilt
        If there is no compiler, or it fails.
    """
    command = command or compiler() or ziglang_command()
    if command is None:
        raise NotBuilt(f"there is no C++ compiler (CXX, c++, g++, clang++); pip install {ZIG} brings one")
    with ThreadPoolExecutor() as pool:  # each thread waits for a compiler process
        return list(pool.map(partial(_compiled, command, folder, digest()), variants()))


def _compiled(command: list[str], folder: Path, mark: str, variant: str) -> Path:
    """Compile a variant into a folder and return the library's path."""
    target = path_of(variant, folder)
    unfinished = target.with_name(f"{target.stem}-{os.getpid()}{SUFFIX}")
    flags = [
        *FLAGS,
        *VARIANTS[variant],
        *([] if sys.platform == "win32" else ["-fPIC"]),
        f'-DCORE_DIGEST="{mark}"',
    ]
    for libraries in (["-nostdlib++", "-lm"], ["-nodefaultlibs", "-lm", "-lc", "-lgcc"], ["-lm"]):
        # the second attempt is for versions of g++ without -nostdlib++
        done = subprocess.run(
            [*command, *flags, "-shared", "-o", str(unfinished), str(SOURCES / "core.cpp"), *libraries],
            capture_output=True,
            text=True,
        )
        if done.returncode == 0:
            os.replace(unfinished, target)
            return target
    raise NotBuilt(f"{shlex.join(command)} fails on native/core.cpp: {done.stderr.strip()[-2000:]}")


def main() -> None:
    """Compile the core in place and print the paths."""
    try:
        for path in build():
            print(path)
    except NotBuilt as error:
        sys.exit(f"The native core is not built: {error}")


if __name__ == "__main__":
    main()
