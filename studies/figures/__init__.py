"""Pictures of the paper's figures: docs/figures.md."""
