"""What `orbits` and `contvines` both need, and what knows neither: figures in one style, doors that lead up, hints, processes."""
