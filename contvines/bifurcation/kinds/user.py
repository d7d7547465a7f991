"""User function: a number that the user has named passes a value. See :func:`contvines.bifurcation.user_functions.kind_of_function`."""

from __future__ import annotations

from ..kind import Kind

KIND = Kind("user", "US", text="user function", nothing="nothing leaves the zero of a user function")
