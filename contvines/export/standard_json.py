"""Standard JSON at full precision."""

import json
import math

import numpy as np


def json_text(data: object, *, indent: int | None = 2) -> str:
    """Standard JSON at full precision; numbers that JSON lacks (nan, infinities) become null."""
    return json.dumps(_finite(data), indent=indent, allow_nan=False, ensure_ascii=False)


def _finite(data: object) -> object:
    if isinstance(data, dict):
        return {str(k): _finite(v) for k, v in data.items()}
    if isinstance(data, np.ndarray):
        return _finite(data.tolist())
    if isinstance(data, list | tuple):
        return [_finite(v) for v in data]
    if isinstance(data, complex | np.complexfloating):
        return _finite([data.real, data.imag])
    if isinstance(data, np.generic):
        data = data.item()
    return None if isinstance(data, float) and not math.isfinite(data) else data
