"""One HTML page from a result: the diagram to zoom and hover, every orbit a click away, no network needed."""
