"""Pictures of the paper's figures: docs/appendix.md."""
