"""Problems: what contvines must be told about one, and two that are made of Python callables."""
