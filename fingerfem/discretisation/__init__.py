"""The finger on a mesh: regions, forms, unknowns."""
