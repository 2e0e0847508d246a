"""Cost of each kind of scene: docs/appendix.md."""
