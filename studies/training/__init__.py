"""The farm and its sets: docs/appendix.md."""
