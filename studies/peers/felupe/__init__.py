"""FElupe in a process of its own, asked for the same states."""
