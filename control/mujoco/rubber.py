"""How near the rubber of a finger comes to what stands in a MuJoCo model: the plates alone collide there.

The model has points along the rubber's four long edges. Between neighbouring sections the rubber is taken as a box,
which MuJoCo measures distances from; only where something is near.
"""

from __future__ import annotations

import mujoco
import numpy as np

from rom.rod.compiled import rubber_boxes
from rom.rod.segment import Segment

NEAR = 0.003  # [m]: gaps that are looked for
BOXES = 24  # from clamp to plate


class Rubber:
    """The rubber of one segment in a compiled model.

    Args:
        model: compiled.
        segment: its map.
        plate: name of its plate's body.
        rubber: name of the geom that distances are measured with.
        own: which geoms belong to the finger, shape (geoms,).
        first: whether it begins in the clamp, not on another plate.
    """

    def __init__(self, model: mujoco.MjModel, segment: Segment, plate: str, rubber: str, own: np.ndarray, first: bool):
        self._segment, self._body = segment, model.body(plate).id
        self._before, half = model.body_parentid[self._body], segment.half_lengths
        y, z = np.array([-1.0, -1.0, 1.0, 1.0]), np.array([-1.0, 1.0, -1.0, 1.0])
        self._begins = np.column_stack([np.full(4, 0.0 if first else half[0]), half[1] * y, half[2] * z])
        self._probe = model.geom(rubber).id
        collides = (model.geom_contype > 0) | (model.geom_conaffinity > 0)
        others = collides & ~own & (np.arange(model.ngeom) != self._probe)
        flat = model.geom_type == mujoco.mjtGeom.mjGEOM_PLANE
        self._planes, self._others = np.flatnonzero(others & flat), np.flatnonzero(others & ~flat)
        self._bounds = model.geom_rbound[self._others]

    def boxes(
        self, data: mujoco.MjData, inputs: np.ndarray, count: int
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray] | None:
        """The rubber from where it begins to the plate, see `rom.rod.compiled.rubber_boxes`."""
        begins = data.xpos[self._before] + self._begins @ data.xmat[self._before].reshape(3, 3).T
        rotation = data.xmat[self._body].reshape(3, 3)
        return rubber_boxes(self._segment.struct, inputs, begins, data.xpos[self._body], rotation, count)

    def gap(self, model: mujoco.MjModel, data: mujoco.MjData, inputs: np.ndarray) -> float:
        """Least distance from anything, at tensions and wrench, shape (t + 6,) [m]; infinite if nothing is near."""
        boxes = self.boxes(data, inputs, BOXES)
        if boxes is None:
            return np.inf
        centres, halves, axes = boxes
        least = np.inf
        for plane in self._planes:
            normal = data.geom_xmat[plane, 2::3]
            behind = (np.abs(normal @ axes) * halves).sum(axis=1)
            least = min(least, float(((centres - data.geom_xpos[plane]) @ normal - behind).min()))
        reach = np.linalg.norm(halves, axis=1)[:, None] + self._bounds + NEAR
        away = centres[:, None] - data.geom_xpos[self._others]
        for k, j in np.argwhere(np.einsum("kji,kji->kj", away, away) < reach * reach):
            model.geom_size[self._probe], data.geom_xpos[self._probe] = halves[k], centres[k]
            data.geom_xmat[self._probe] = axes[k].ravel()
            least = min(least, mujoco.mj_geomDistance(model, data, self._probe, int(self._others[j]), NEAR, None))
        return float(least) if least < NEAR else np.inf
