"""Machines: one file each; `base` has what they all offer, `names` their names, `catalogue` finds them."""
