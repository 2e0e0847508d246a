"""The surrogate: docs/surrogate.md."""
