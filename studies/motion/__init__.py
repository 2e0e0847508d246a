"""Motion: rod elements against the full-order model."""
