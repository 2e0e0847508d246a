"""Where a set needs more states."""
