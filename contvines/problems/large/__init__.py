"""Problems with many unknowns: sparse and matrix-free equations."""
