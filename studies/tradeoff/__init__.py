"""Speed against accuracy: docs/speed.md."""
