"""Points of contact and their forces, with and without friction."""
