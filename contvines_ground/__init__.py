"""What `orbits` and `contvines` both stand on, and what knows neither: figures in one style, doors that lead up, hints."""
