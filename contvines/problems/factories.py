"""The factories of this package's own problems; names of earlier versions stay, for their files."""

FACTORIES = {
    "contvines.flows.files:from_description": "contvines.flows.files:from_description",
    "contvines.loci.problem:from_description": "contvines.loci.problem:from_description",
    "contvines.problems.algebraic:from_description": "contvines.problems.algebraic:from_description",
    "contvines.problems.maps:from_description": "contvines.problems.maps:from_description",
    "contvines.algebraic:from_description": "contvines.problems.algebraic:from_description",
    "contvines.map_problem:from_description": "contvines.problems.maps:from_description",
}
