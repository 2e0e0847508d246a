"""Tapered fingers of prismatic elements against the full-order model: docs/accuracy.md."""
