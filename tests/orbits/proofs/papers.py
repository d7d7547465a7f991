"""Certificates as a file holds them, and the decimal balls of proofs."""

import json

from mpmath import mpf

from orbits.proofs.checker import check


def checked(proof):
    """The certificate of a proof, verified."""
    paper = json.loads(json.dumps(proof.certificate()))
    check(paper)
    return paper


def holds(ball, number, slack="1e-44"):
    """Whether a ball holds a number that is known but for `slack`, in mpmath's present precision."""
    middle, radius = map(mpf, ball)
    return abs(middle - mpf(number)) <= radius + mpf(slack)
