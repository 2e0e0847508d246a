"""docs/accuracy.md: fingers assembled from rod elements, and contact that is solved for about them."""
