"""The full-order solver: docs/appendix.md."""
