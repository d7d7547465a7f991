"""Newton's method, by the name that it had for pages."""

from orbits.flows.solving import newton as newton
