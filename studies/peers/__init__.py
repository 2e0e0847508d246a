"""Alternatives to this project, on the same finger."""
