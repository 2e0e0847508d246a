"""Whether what the finger that comes along says of its error is true: docs/coverage.md."""
