"""Loci: special points continued in a second parameter, points of codimension two on them, and charts of two parameters."""
