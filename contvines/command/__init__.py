"""The command line and the TOML studies it reads: the one place where `contvines` and `orbits` meet."""
