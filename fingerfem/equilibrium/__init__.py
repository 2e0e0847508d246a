"""From loads to equilibria, and what is known of an equilibrium."""
