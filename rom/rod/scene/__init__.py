"""The scene of a rod: read, and compared with that of its elements."""
