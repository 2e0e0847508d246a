"""The parts of docs/appendix.md."""

from studies.figures import errors, figures, held

PARTS = {"figures": figures.measure, "held": held.measure, "errors": errors.measure}
