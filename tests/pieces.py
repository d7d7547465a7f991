"""Pieces of work for `test_processes`: small ones, and ones that end their process."""

import os
from pathlib import Path


def square(number):
    return number * number, os.getpid()


def deadly(number, folder):
    """The square; what is divisible by 7 ends the process, and 3 does so once. Each attempt leaves a line."""
    with (Path(folder) / str(number)).open("a") as file:
        file.write("begun\n")
    if number % 7 == 0 or (number == 3 and len((Path(folder) / "3").read_text().splitlines()) == 1):
        os._exit(1)
    return number * number


def wrong(number):
    if number == 5:
        raise KeyError(f"{number} is no good")
    return lambda: None  # cannot be sent
