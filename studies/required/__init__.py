"""What each kind of scene costs: docs/appendix.md."""
