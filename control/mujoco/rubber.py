"""How near the rubber of a finger comes to what stands in a MuJoCo model: the plates alone collide there.

The map knows points along the rubber's four long edges. Between neighbouring sections the rubber is taken as a box,
which MuJoCo measures distances from; only where something is near.
"""

from __future__ import annotations

import mujoco
import numpy as np

from rom.segment.segment_map import SegmentMap

NEAR = 0.003  # [m]: gaps that are looked for
EDGES, PARTS = 4, 4  # of a section; boxes between two stations that the map knows


class Rubber:
    """The rubber of one segment in a compiled model.

    Args:
        model: compiled.
        segment: its map.
        plate: name of its plate's body.
        own: which geoms belong to the finger, shape (geoms,).
    """

    def __init__(self, model: mujoco.MjModel, segment: SegmentMap, plate: str, own: np.ndarray):
        self._segment, self._body = segment, model.body(plate).id
        self._probe = model.geom(f"{plate} rubber").id
        collides = (model.geom_contype > 0) | (model.geom_conaffinity > 0)
        self._others = np.flatnonzero(collides & ~own & (np.arange(model.ngeom) != self._probe))
        bounds = model.geom_rbound[self._others]
        self._reach = np.where(bounds > 0, bounds, np.inf)  # planes have no end
        self._sections = np.zeros((0, 0))
        if segment.skin is not None:
            stations = segment.skin.coefficients.shape[1] // (3 * EDGES)
            places = np.linspace(0, stations - 1, PARTS * (stations - 1) + 1)
            self._sections = np.array([np.interp(places, np.arange(stations), row) for row in np.eye(stations)]).T

    def gap(self, model: mujoco.MjModel, data: mujoco.MjData, inputs: np.ndarray) -> float:
        """Least distance from anything, at tensions and wrench, shape (t + 6,) [m]; infinite if nothing is near."""
        skin = self._segment.skin
        if skin is None:
            return np.inf
        held = np.clip(inputs, skin.lower, skin.upper)
        known = skin.value(held[None])[0].reshape(-1, EDGES, 3)
        rotation = data.xmat[self._body].reshape(3, 3)
        corners = np.einsum("ps,sei->pei", self._sections, known) @ rotation.T + data.xpos[self._body]
        before, after = corners[:-1], corners[1:]
        both, centres = (before + after) / 2, (before + after).mean(axis=1) / 2
        along, across = (after - before).mean(axis=1), both[:, 1] + both[:, 3] - both[:, 0] - both[:, 2]
        lengths = np.linalg.norm(along, axis=1)
        x = along / lengths[:, None]
        y = across - np.sum(across * x, axis=1)[:, None] * x
        widths = np.linalg.norm(y, axis=1)
        y /= widths[:, None]
        z = np.cross(x, y)
        depths = np.abs(np.sum((both[:, 2] + both[:, 3] - both[:, 0] - both[:, 1]) * z, axis=1))
        halves = np.column_stack([lengths / 2, widths / 4, depths / 4])
        away = np.linalg.norm(centres[:, None] - data.geom_xpos[self._others], axis=2)
        near = away < self._reach + np.linalg.norm(halves, axis=1)[:, None] + NEAR
        least = np.inf
        for k, j in np.argwhere(near):
            model.geom_size[self._probe], data.geom_xpos[self._probe] = halves[k], centres[k]
            data.geom_xmat[self._probe] = np.column_stack([x[k], y[k], z[k]]).ravel()
            found = mujoco.mj_geomDistance(model, data, self._probe, int(self._others[j]), NEAR, None)
            least = min(least, found) if found < NEAR else least
        return float(least)
