"""Contact with Coulomb's friction: what sticks, what slides, along a history."""
