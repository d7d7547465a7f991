"""Problems with many unknowns: kernels for sparse and matrix-free Jacobians."""
