"""Functions that rebuild problems from their descriptions: name in a file -> where the function is.

Names of earlier versions stay, for their files. A function takes (description, trust); what a description says is data,
code that it names is run only with ``trust``.
"""

FACTORIES = {
    "orbits.flows.page.smooth:rebuild": "orbits.flows.page.smooth:rebuild",
    "orbits.problem:rebuild": "orbits.problem:rebuild",
    "orbits.cycles.stuck_problem:rebuild": "orbits.problem:rebuild",
    "orbits.stuck_problem:rebuild": "orbits.problem:rebuild",
    "orbits.declared.stored:rebuild": "orbits.problem:rebuild",
    "orbits.machines.declared.stored:rebuild": "orbits.problem:rebuild",
}
