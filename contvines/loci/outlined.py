"""Plain calls of a problem's kernels, which would else be inlined at every place where a locus calls them."""

from typing import Any

kernel: Any = None  # put in by contvines.loci.binding


def linearise(data, u, p, work):
    """See the protocol."""
    return kernel(data, u, p, work)


def bordered(data, work, border, n, step, tangent):
    """See the protocol."""
    return kernel(data, work, border, n, step, tangent)


def inspect(data, u, p, work, row):
    """See the protocol."""
    kernel(data, u, p, work, row)


def assign(data, other, value):
    """See the protocol."""
    kernel(data, other, value)


def flip(data, work, sign):
    """See the protocol."""
    kernel(data, work, sign)


def transpose(data, work, column, other):
    """See the protocol."""
    kernel(data, work, column, other)
