"""Numbers for people."""

ROUNDING = 1e-14  # beside numbers of order one this is zero


def number_text(value: float, digits: int = 10, unit: float = 1.0) -> str:
    """A number with so many digits; what is only rounding beside ``unit`` is 0."""
    return "0" if abs(value) <= ROUNDING * abs(unit) else f"{value:.{digits}g}"
