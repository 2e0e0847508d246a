"""Motion of a finger in time steps."""
