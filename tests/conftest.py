"""What all tests share: a native core that belongs to its sources; hypothesis draws the same examples every time, however long they take; `pytest --hypothesis-profile=search` draws new ones."""

from contextlib import suppress

from hypothesis import settings

from contvines.core.build import NotBuilt, build, up_to_date
from tests.children import adopt, no_child_survives_its_test

__all__ = ["no_child_survives_its_test"]
adopt()

settings.register_profile("repeatable", derandomize=True, deadline=None)
settings.register_profile("search", derandomize=False, deadline=None)
settings.load_profile("repeatable")

if not up_to_date():
    with suppress(NotBuilt):  # the reference core computes then
        build()
