"""A finger in steps of time."""
