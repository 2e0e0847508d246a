"""Studies: scripts that measure the project against the paper, against itself and at the extremes."""
