"""Several objects at once, wrapped cylinders, and friction, against the full-order model."""
