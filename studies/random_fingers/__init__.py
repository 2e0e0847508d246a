"""Random fingers, each solved or refused: docs/appendix.md."""
