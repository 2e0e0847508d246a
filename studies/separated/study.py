"""The parts of docs/accuracy.md."""

from studies.separated import separated

PARTS = {"rod": separated.of_the_rod, "plain": separated.without_alignment, "grid": separated.of_states}
