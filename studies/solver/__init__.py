"""The full-order solver: docs/solver.md."""
