"""The tip on a path in time: docs/accuracy.md."""
