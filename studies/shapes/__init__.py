"""Fingers of several sections, each of its own elements, against the full-order model: docs/accuracy.md."""
