"""Samples of elements from full-order states: sections, cuts, images, and the combinations of tensions."""
