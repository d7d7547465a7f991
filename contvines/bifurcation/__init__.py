"""Special points: their kinds, how they are detected, located, checked, classified, and the branches that leave them."""
