"""Sets of states: which to solve, the ranks that solve them, what is kept."""
