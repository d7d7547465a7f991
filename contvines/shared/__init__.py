"""What `orbits` and `contvines` both need, and what knows neither: figures in one style, hints, processes."""
