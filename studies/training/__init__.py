"""The farm and its sets: docs/training.md."""
