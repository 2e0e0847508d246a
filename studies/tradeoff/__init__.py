"""Speed against accuracy: docs/tradeoff.md."""
