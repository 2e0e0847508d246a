"""A finger on few nodes."""

import pytest

SIDE = 0.01


@pytest.fixture
def moving() -> dict:
    """A soft finger with one tendon and no obstacle, as plain data; its channel is a third of the section wide."""
    return {
        "name": "moving",
        "geometry": {"side": SIDE, "segments": [0.05], "plate": 0.001, "channel": SIDE / 3},
        "material": {"law": "neo-hookean", "E": 1e6, "nu": 0.3},
        "density": {"rubber": 1100.0},
        "tendons": [{"name": "F1", "offset": [SIDE / 3, 0.0], "segment": 1, "tension": [0.0, 10.0]}],
        "mesh": {"cells": [9, 3]},
    }
