"""The controllers' compiled part: bounded least squares, questions to a finger, rods in MuJoCo (see the headers)."""

from pathlib import Path

from rom.native import EVALUATION, SEGMENT, Library

_HERE = Path(__file__).parent
_SOURCES = ("least_squares.c", "step.c", "null_space.c", "hold.c", "reach.c", "locate.c", "rod.c")
CONTROL = Library(
    "control",
    headers=[_HERE / "least_squares.h", _HERE / "problems.h", _HERE / "rod.h"],
    units=[*(_HERE / source for source in _SOURCES), *EVALUATION.units, *SEGMENT.units],
    includes=SEGMENT,
)
