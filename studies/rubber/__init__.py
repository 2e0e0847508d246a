"""Contact on the rubber against the full-order model: forces, indentation, robustness."""
