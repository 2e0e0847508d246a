"""Objects that a finger may touch: their shapes, and the search for their position."""
