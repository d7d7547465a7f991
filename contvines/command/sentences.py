"""Refusals with the place that they are about before them."""

from collections.abc import Iterator
from contextlib import contextmanager


@contextmanager
def refused(place: str, *kinds: type[Exception]) -> Iterator[None]:
    """Say of which place a refusal is.

    Parameters
    ----------
    place : str
        A file, field or option, with its value.
    *kinds : type of Exception
        What is refused beside `ValueError`.

    Raises
    ------
    ValueError
    """
    try:
        yield
    except (ValueError, *kinds) as error:
        raise ValueError(f"{place}: {str(error).rstrip('.')}.") from error
