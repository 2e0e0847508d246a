"""The ends of every range: docs/extremes.md."""
