"""docs/segment.md: the map of a segment, and contact solved about it."""
