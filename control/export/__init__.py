"""Exports that contain controllers: the browser page and the controller's FMU."""

from pathlib import Path

from control.native import CONTROL

_SOLVERS = "least_squares.c", "step.c", "null_space.c", "hold.c"
NATIVE = Path(__file__).parent / "native"
# A hold without Python, besides the models' library.
UNITS = [NATIVE / "standalone.c", *(unit for unit in CONTROL.units if unit.name in _SOLVERS)]
