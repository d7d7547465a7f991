"""Problems: what contvines must know about one, and two that are made of Python callables."""
