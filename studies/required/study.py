"""The parts of docs/appendix.md."""

from studies.required import required

PARTS = {"required": required.measure}
