"""The elastic rod with two columns of gas: a pressure p in a column of area A pushes as a tension -A p would pull.

The column becomes larger by A times what it becomes longer, which is the stroke that its pressure does work on.
"""

from dataclasses import replace
from typing import Any

import numpy as np

from rom.elements.samples.section_states import SectionStates
from rom.elements.samples.symmetry import mirrors
from tests.rom.elements import elastic_rod

TENDON, CENTRES = np.array([[0.0, 0.0]]), np.array([[-0.0025, 0.0], [0.0025, 0.0]])  # (y, z) [m]
SIZE, X = [0.003, 0.006], [0.002, 0.047]  # of the columns along y and z, and along the axis [m]
AREA, HIGHEST = SIZE[0] * SIZE[1], 5e5  # [m^2], [Pa]
LOADS = 3
TO_TENSIONS = np.array([1.0, -AREA, -AREA])


def scene() -> dict[str, Any]:
    """The rod's scene, as plain data."""
    chambers = [
        {"name": f"p{k + 1}", "region": "rectangle", "centre": centre, "size": SIZE, "x": X, "pressure": [0.0, HIGHEST]}
        for k, centre in enumerate(CENTRES.tolist())
    ]
    one = elastic_rod.scene(offsets=TENDON)
    tendons = [one["tendons"][0] | {"tension": [0.0, 10.0]}]
    return one | {"name": "chambered rod", "tendons": tendons, "chambers": chambers}


def two_segments(**changes) -> dict:
    """The rod twice, with the tendon along both, and in the second segment chambers p3 and p4."""
    finger, length = scene(), elastic_rod.LENGTH
    finger["geometry"] |= {"segments": [length, length]}
    finger["tendons"] = [tendon | {"segment": 2} for tendon in finger["tendons"]]
    finger["chambers"] += [
        chamber | {"name": f"p{k}", "x": [length + part for part in chamber["x"]]}
        for k, chamber in enumerate(finger["chambers"], 3)
    ]
    return finger | changes


def pressed(count: int, seed: int) -> np.ndarray:
    """Inputs: tension [N], pressures [Pa], wrench [N, N m], shape (5 count, 9)."""
    inputs = elastic_rod.pressed(count, seed, np.concatenate([TENDON, CENTRES]))
    inputs[:, :LOADS] *= np.array([10.0, HIGHEST, HIGHEST]) / elastic_rod.MOST_TENSION
    return inputs


def states(count: int, seed: int) -> SectionStates:
    """States of the rod with their derivatives, as a set would hold them."""
    inputs = pressed(count, seed)
    forces = np.concatenate([inputs[:, :LOADS] * TO_TENSIONS, inputs[:, LOADS:]], axis=1)
    found = elastic_rod.states_at(forces, np.repeat(np.arange(count), 5), offsets=np.concatenate([TENDON, CENTRES]))
    by = np.append(TO_TENSIONS, np.ones(6))
    return replace(
        found,
        scene=scene(),
        inputs=inputs,
        sections=replace(found.sections, motions=found.sections.motions * by),
        plate=replace(found.plate, motions=found.plate.motions * by),
        shortenings=found.shortenings * TO_TENSIONS,
        shortening_changes=found.shortening_changes * TO_TENSIONS[:, None] * by,
        mirrors=mirrors(scene()),
    )
