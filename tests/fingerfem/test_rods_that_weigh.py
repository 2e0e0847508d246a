"""A soft finger that sags by its weight: a rod, of elements without weight, beside the full-order model."""

import tomllib

import numpy as np
import pytest
from assembled import scaled

from fingerfem import FingerModel
from fingerfem.scene.scene import Scene
from rom import Rod, TouchedSegment
from rom.rod.objects.shapes import facing_plane

SOFTER, STATES, DEPTH = 40.0, 5, 0.75  # than the trained rubber; of the way to the plane that touches [-]
WEIGHT = {"density": 1070.0, "plate_density": 7850.0}
# Largest errors on the trained mesh: of the tip over its displacement, and of contact forces [-]. Measured: in ten
# states 0.015 % and 0.014 % without weight; 0.026 % and 0.069 % with it, by which the tip moves by 3 to 4 mm.
TIP, FORCE = 5e-4, 1.5e-3


@pytest.mark.parametrize("direction", [None, (0.0, 1.0, 0.0), (-0.5, 0.7, -0.6)])
def test_tip_and_force_are_those_of_the_full_order_model(demo, direction):
    gravity = {} if direction is None else {"gravity": WEIGHT | {"direction": list(direction)}}
    light = scaled(Rod.load(demo / "finger.h5"), modulus=1 / SOFTER)
    finger = light.assembled(light.scene | gravity)
    scene = tomllib.loads((demo / "plane.toml").read_text())
    scene |= {"material": light.scene["material"], "tendons": light.scene["tendons"]} | gravity
    full = FingerModel(Scene.model_validate(scene))
    model = TouchedSegment(rod=finger, obstacle=facing_plane(0.01, (0.0, 0.05)))
    random = np.random.default_rng(3)
    tensions = random.uniform([0.35, 0.0], [0.75, 0.5], (STATES, 2)) * 100 / SOFTER
    for pulled in tensions:
        free = model.evaluate([*pulled, np.inf])
        distance = DEPTH * float(free.touch_distance)
        pressed = model.evaluate([*pulled, distance])
        tip, force = full.solve(pulled).tip, full.solve(pulled, distance).contact_force
        assert free.inside and pressed.inside and force > 0.02
        assert np.linalg.norm(free.tip - tip) < TIP * np.linalg.norm(tip)
        assert float(pressed.contact_force) == pytest.approx(force, rel=FORCE)
        sag = np.linalg.norm(free.tip - light.place(pulled).centres[-1] + light.rest)
        assert sag == pytest.approx(0, abs=1e-12) if direction is None else sag > 2e-3
