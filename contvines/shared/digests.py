"""What tells runs apart: a digest of all that decides a result."""

import hashlib
import json


def digest_of(data: object) -> str:
    """The same for equal data, ready for JSON; in files since version 0.1, so that it stays what it is."""
    return hashlib.sha256(json.dumps(data, sort_keys=True, default=str).encode()).hexdigest()
