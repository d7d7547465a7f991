"""What all tests share: hypothesis draws the same examples every time, however long they take; `pytest --hypothesis-profile=search` draws new ones."""

from hypothesis import settings

settings.register_profile("repeatable", derandomize=True, deadline=None)
settings.register_profile("search", derandomize=False, deadline=None)
settings.load_profile("repeatable")
