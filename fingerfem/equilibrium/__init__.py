"""Equilibria under loads, and their properties."""
