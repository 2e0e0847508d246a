"""The parts of docs/required.md."""

from studies.required import required

PARTS = {"required": required.measure}
