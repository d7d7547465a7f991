"""Loci: special points followed in a second parameter, points of codimension two, charts."""
