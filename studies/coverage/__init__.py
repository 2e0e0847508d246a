"""Estimated errors of the bundled finger against true ones: docs/coverage.md."""
