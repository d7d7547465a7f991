"""The reduced absorber of the literature, as studies of several tests begin."""

PAPER_MACHINE = """[model]
name = "absorber"
restitution = 0.76
friction = 0.5
gravity = 0.211
mass_ratio = 0.006
"""
