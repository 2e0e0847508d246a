"""Estimated errors of the bundled finger against true ones: docs/accuracy.md."""
