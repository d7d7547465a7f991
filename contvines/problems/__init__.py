"""Problems F(u, p) = 0: the protocol that contvines requires of them, and problems made of Python callables."""
