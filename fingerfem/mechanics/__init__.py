"""Finite-strain mechanics of the finger in UFL, without a mesh."""
