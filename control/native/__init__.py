"""The controllers' compiled part: least squares, questions to a finger, fingers in MuJoCo (see the headers)."""

from pathlib import Path

from rom.native import LIBRARY, Library

_HERE = Path(__file__).parent
CONTROL = Library(
    "control",
    _HERE,
    headers=[
        *("least_squares.h", "control.h", "feel.h"),
        *("sections.h", "engine.h", "rubber_contacts.h", "friction.h"),
    ],
    units=sorted(_HERE.glob("*.c")),
    stands_on=LIBRARY,
)
