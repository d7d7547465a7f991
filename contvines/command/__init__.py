"""The command line and the TOML studies that it reads; the only part of `contvines` that imports `orbits`."""
