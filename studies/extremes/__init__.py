"""The ends of every range: docs/appendix.md."""
