"""The study of docs/accuracy.md."""
