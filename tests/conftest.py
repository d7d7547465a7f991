"""What all tests share: a native core that belongs to its sources; hypothesis draws the same examples every time, however long they take; `pytest --hypothesis-profile=search` draws new ones."""

import os
from contextlib import suppress

from hypothesis import HealthCheck, settings
from hypothesis.internal.conjecture import providers

from contvines.core.build import NotBuilt, build, up_to_date
from contvines.survey import pools
from tests.children import adopt, no_child_survives_its_test

__all__ = ["no_child_survives_its_test"]
adopt()

settings.register_profile(
    "patient", deadline=None, suppress_health_check=[HealthCheck.too_slow]
)  # on a loaded machine
settings.register_profile("repeatable", settings.get_profile("patient"), derandomize=True)
settings.register_profile("search", settings.get_profile("patient"), derandomize=False)
settings.load_profile("repeatable")
# else numbers in source files are drawn more often, and the examples depend on the modules that a worker has imported so far
providers.is_local_module_file = lambda path: False  # pyright: ignore[reportPrivateImportUsage]

if "PYTEST_XDIST_WORKER" in os.environ:
    pools.cores = lambda: 1  # every core has tests of its own; those of several processes say how many


def pytest_collection_modifyitems(items):
    """Long tests begin first: one that begins last leaves all cores but its own without work."""
    items.sort(key=lambda item: item.get_closest_marker("long") is None)


if not up_to_date():
    with suppress(NotBuilt):  # the reference core computes then
        build()
