"""Fingers that are assembled from elements of another one, and a finger of four tendons: docs/accuracy.md."""
