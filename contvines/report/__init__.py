"""Reports: one HTML page per result, with a diagram to zoom and the orbit of each clicked point; it needs no network."""
