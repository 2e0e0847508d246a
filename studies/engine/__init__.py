"""Contact forces in MuJoCo against the full-order model: docs/accuracy.md."""
