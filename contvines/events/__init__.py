"""Events: what to watch along a branch, and how to locate it. The continuation loop knows nothing of them."""
