"""The bundled silicone fingers with weight, free and before a plane, beside the full-order model on finer meshes."""

import tomllib
from pathlib import Path

import numpy as np
import pytest

import rom
from fingerfem import FingerModel
from fingerfem.scene.scene import Scene

SCENES = Path(__file__).resolve().parents[2] / "scenes" / "silicone"
# Largest errors of the free tip over its displacement, and of contact forces [-]. Measured: 0.07 and 0.8 %.
# All errors of free tips and of forces are within their estimates.
LIMITS = {"round": (1e-3, 0.01), "square": (1e-3, 0.01)}
TENSIONS = [[6.6, 2.8, 1.4, 7.9], [8.5, 5.9, 3.1, 3.2], [9.0, 1.0, 0.0, 0.0], [10.0, 0.0, 0.0, 0.0]]  # [N]
DEPTH = 0.85  # of the way to the plane that touches [-]


@pytest.mark.long
@pytest.mark.parametrize("name", LIMITS)
def test_tip_and_contact_force_are_those_of_the_full_order_model(name):
    table = tomllib.loads((SCENES / f"{name}.toml").read_text()) | {"obstacle": {"distance": [0.001, 0.04]}}
    table["mesh"] = tomllib.loads((SCENES / f"{name}_finest.toml").read_text())["mesh"]
    full = FingerModel(Scene.model_validate(table))
    model, (of_tip, of_force) = rom.load(name), LIMITS[name]
    for tensions in TENSIONS:
        free = model.evaluate([*tensions, np.inf])
        pressed = model.evaluate([*tensions, DEPTH * float(free.touch_distance)])
        tip = full.solve(tensions, sensitivities=False).tip
        force = full.solve(tensions, DEPTH * float(free.touch_distance), sensitivities=False).contact_force
        assert free.inside and pressed.inside and force > 0.03
        off, off_by = np.linalg.norm(free.tip - tip), abs(float(pressed.contact_force) - force)
        assert off < of_tip * np.linalg.norm(tip) and off < free.error["tip"]
        assert off_by < of_force * force and off_by < pressed.error["contact_force"]
