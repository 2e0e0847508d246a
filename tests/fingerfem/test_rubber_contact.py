"""A bar across the rubber of the bundled finger, beside the full-order model on a coarse mesh."""

import tomllib
from pathlib import Path

import numpy as np
import pytest

from fingerfem import FingerModel
from fingerfem.scene.scene import Scene
from rom import Cylinder, TouchedSegment

SCENES = Path(__file__).parents[2] / "scenes"
TENSIONS, DEPTH = np.array([30.0, 10.0]), 5e-4  # [N], [m]


def test_a_bar_across_the_rubber_presses_as_on_the_full_order_finger():
    """From where either touches: the coarse mesh, the indentation and the surface are some per cent of the force."""
    direction, radius = (0.0, -1.0, 0.0), 0.012
    finger = TouchedSegment.load().rod
    section = finger.sections(TENSIONS, at=[0.027])
    centre = section.centres[0] + np.array(direction) * (radius + 0.02)
    where = {"centre": tuple(centre), "direction": direction, "radius": radius, "axis": (0.0, 0.0, 1.0)}
    model = TouchedSegment(rod=finger, obstacle=Cylinder(**where, distances=(-0.05, 0.05)))
    touch = float(model.outputs([[*TENSIONS, np.inf]])[0, 4])
    tables = tomllib.loads((SCENES / "draft.toml").read_text())
    away = tuple(centre + (touch - 0.02) * np.array(direction))  # it touches where d is 20 mm
    tables["obstacle"] = {"shape": "cylinder", "method": "penalty", "distance": [1e-4, 0.04]}
    tables["obstacle"] |= {
        "centre": list(away),
        "direction": list(direction),
        "radius": radius,
        "axis": [0.0, 0.0, 1.0],
    }
    tables.pop("tactile_pad", None)
    tables["mesh"] = {"cells": [12, 5], "order": 2}
    full = FingerModel(Scene.model_validate(tables))
    free = full.solve(TENSIONS, 0.04)
    assert free.touch_distance == pytest.approx(0.02, abs=5e-4)  # the coarse mesh bends less
    force = full.solve(TENSIONS, free.touch_distance - DEPTH).contact_force
    found = model.evaluate([*TENSIONS, touch - DEPTH])
    assert found.inside and force > 0.1
    assert abs(float(found.contact_force) - force) < 0.1 * force
