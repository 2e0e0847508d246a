"""The full-order finger in motion: inertia, viscoelastic branches, impacts; and its modes."""
