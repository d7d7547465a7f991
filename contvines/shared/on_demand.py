"""Names of a package that are imported when they are first asked for."""

from __future__ import annotations

import sys
from collections.abc import Callable, Mapping
from importlib import import_module


def on_demand(package: str, homes: Mapping[str, str]) -> Callable[[str], object]:
    """The ``__getattr__`` of a package: each name is taken from the module that holds it; ``homes`` has the modules by name.

    A home that is a module of the name itself is handed out whole.
    """

    def find(name: str) -> object:
        if name not in homes:
            if name.startswith("_"):
                raise AttributeError(f"{package} has no {name!r}")
            from contvines.shared.near_names import did_you_mean

            raise AttributeError(
                f"{package} has no {name!r}{did_you_mean(name, homes)}; it has {', '.join(sorted(homes))}"
            )
        home = import_module(homes[name])
        found = home if homes[name] == f"{package}.{name}" else getattr(home, name)
        setattr(sys.modules[package], name, found)
        return found

    return find
