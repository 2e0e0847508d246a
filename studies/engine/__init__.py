"""Contact forces of a finger in MuJoCo, compared with the full-order model."""
